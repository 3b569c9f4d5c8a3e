// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/survey/event_survey.hpp"

#include <algorithm>

namespace edged {
namespace {

constexpr Duration kBin = std::chrono::milliseconds(10);
constexpr int kMostSide = 2048;  // pixels beyond are not counted one by one; the largest sensor today has 1280 x 720
constexpr std::size_t kListedHotPixels = 10;

std::size_t area(cv::Size size) { return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height); }

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

}  // namespace

EventSurveyor::EventSurveyor(cv::Size sensor)
    : sensor_(sensor),
      counted_(sensor.empty() ? cv::Size(kMostSide, kMostSide)
                              : cv::Size(std::min(sensor.width, kMostSide), std::min(sensor.height, kMostSide))),
      pixels_(area(counted_)) {}

void EventSurveyor::add(std::span<const Event> events) {
  for (const Event& event : events) {
    if (bin_end_ == Timestamp::min()) bin_end_ = event.t + kBin;
    if (event.t >= bin_end_) close_bin(static_cast<std::size_t>((event.t - bin_end_) / kBin) + 1);
    ++bin_events_;
    ++events_;
    positive_ += event.positive;
    extent_.width = std::max(extent_.width, event.x + 1);
    extent_.height = std::max(extent_.height, event.y + 1);
    if (event.x < counted_.width && event.y < counted_.height) ++pixels_[place(event.x, event.y)];
  }
}

/// Ends the bin that is being counted; the others of so many are empty.
void EventSurveyor::close_bin(std::size_t bins) {
  const double rate = static_cast<double>(bin_events_) / to_seconds(kBin);
  const auto band = std::ranges::upper_bound(EventSurvey::kRateBands, rate) - EventSurvey::kRateBands.begin();
  ++band_bins_[static_cast<std::size_t>(band)];
  band_bins_[0] += bins - 1;
  peak_ = std::max(peak_, std::exchange(bin_events_, 0));
  bins_ += bins;
  bin_end_ += static_cast<Duration::rep>(bins) * kBin;
}

EventSurvey EventSurveyor::result() const {
  EventSurveyor ended = *this;
  if (bin_events_ > 0) ended.close_bin(1);
  EventSurvey survey;
  survey.positive_share = share(positive_, events_);
  survey.peak_rate_hz = static_cast<double>(ended.peak_) / to_seconds(kBin);
  for (std::size_t i = 0; i < survey.rate_shares.size(); ++i)
    survey.rate_shares[i] = share(ended.band_bins_[i], ended.bins_);
  survey.extent = extent_;
  find_hot_pixels(survey);
  return survey;
}

std::size_t EventSurveyor::place(int x, int y) const {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(counted_.width) + static_cast<std::size_t>(x);
}

/// Far above most pixels, and far above those beside it: an edge or a thing that moves is not alone.
bool EventSurveyor::is_hot(int x, int y, double limit) const {
  constexpr double kAboveNeighbours = 10.0;
  const double events = pixels_[place(x, y)];
  if (events <= limit) return false;
  std::vector<std::uint32_t> around;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, counted_.height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, counted_.width - 1); ++u)
      if (u != x || v != y) around.push_back(pixels_[place(u, v)]);
  std::ranges::sort(around);
  return around.empty() || events > kAboveNeighbours * around[around.size() / 2];
}

void EventSurveyor::find_hot_pixels(EventSurvey& survey) const {
  std::vector<std::uint32_t> fired;
  std::ranges::copy_if(pixels_, std::back_inserter(fired), [](std::uint32_t count) { return count > 0; });
  if (fired.empty()) return;
  survey.active_share = share(fired.size(), area(sensor_.empty() ? extent_ : sensor_));
  const auto middle = fired.begin() + static_cast<std::ptrdiff_t>(fired.size() / 2);
  std::ranges::nth_element(fired, middle);
  const double limit = EventSurvey::kHotFactor * *middle;
  std::size_t hot_events = 0;
  for (int y = 0; y < std::min(extent_.height, counted_.height); ++y)
    for (int x = 0; x < std::min(extent_.width, counted_.width); ++x) {
      if (!is_hot(x, y, limit)) continue;
      ++survey.hot_pixels;
      hot_events += pixels_[place(x, y)];
      survey.hottest.push_back({x, y, pixels_[place(x, y)]});
    }
  std::ranges::stable_sort(survey.hottest, std::greater<>(), &HotPixel::events);
  survey.hottest.resize(std::min(survey.hottest.size(), kListedHotPixels));
  survey.hot_share = share(hot_events, events_);
}

}  // namespace edged
