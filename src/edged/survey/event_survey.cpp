// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/survey/event_survey.hpp"

#include <algorithm>

namespace edged {
namespace {

constexpr Duration kBin = std::chrono::milliseconds(10);
const cv::Size kUnknownSensor(2048, 2048);  // the largest there is today has 1280 x 720
constexpr std::size_t kListedHotPixels = 10;

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

}  // namespace

EventSurveyor::EventSurveyor(cv::Size sensor)
    : sensor_(sensor), pixels_(static_cast<std::size_t>((sensor.empty() ? kUnknownSensor : sensor).area())) {}

void EventSurveyor::add(std::span<const Event> events) {
  const cv::Size size = sensor_.empty() ? kUnknownSensor : sensor_;
  for (const Event& event : events) {
    if (bin_end_ == Timestamp::min()) bin_end_ = event.t + kBin;
    if (event.t >= bin_end_) close_bin(static_cast<std::size_t>((event.t - bin_end_) / kBin) + 1);
    ++bin_events_;
    ++events_;
    positive_ += event.positive;
    extent_.width = std::max(extent_.width, event.x + 1);
    extent_.height = std::max(extent_.height, event.y + 1);
    if (event.x < size.width && event.y < size.height)
      ++pixels_[event.y * static_cast<std::size_t>(size.width) + event.x];
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

void EventSurveyor::find_hot_pixels(EventSurvey& survey) const {
  const cv::Size size = sensor_.empty() ? kUnknownSensor : sensor_;
  std::vector<std::uint32_t> fired;
  std::ranges::copy_if(pixels_, std::back_inserter(fired), [](std::uint32_t count) { return count > 0; });
  if (fired.empty()) return;
  const cv::Size shown = sensor_.empty() ? extent_ : sensor_;
  survey.active_share = share(fired.size(), static_cast<std::size_t>(shown.area()));
  const auto middle = fired.begin() + static_cast<std::ptrdiff_t>(fired.size() / 2);
  std::ranges::nth_element(fired, middle);
  const double limit = EventSurvey::kHotFactor * *middle;
  std::size_t hot_events = 0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    if (pixels_[i] <= limit) continue;
    ++survey.hot_pixels;
    hot_events += pixels_[i];
    const auto width = static_cast<std::size_t>(size.width);
    survey.hottest.push_back({static_cast<int>(i % width), static_cast<int>(i / width), pixels_[i]});
  }
  std::ranges::stable_sort(survey.hottest, std::greater<>(), &HotPixel::events);
  survey.hottest.resize(std::min(survey.hottest.size(), kListedHotPixels));
  survey.hot_share = share(hot_events, events_);
}

}  // namespace edged
