// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/event_statistics.hpp"

#include <algorithm>

namespace edged {
namespace {

constexpr Duration kBin = std::chrono::milliseconds(10);
// Pixels beyond it are not counted individually. The largest sensor at present has 1280 x 720.
constexpr int kMostSide = 2048;
constexpr std::size_t kListedHotPixels = 10;

std::size_t area(cv::Size size) { return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height); }

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

/// The largest sensor, if the size is unknown.
cv::Size counted_area(cv::Size sensor) {
  return sensor.empty() ? cv::Size(kMostSide, kMostSide)
                        : cv::Size(std::min(sensor.width, kMostSide), std::min(sensor.height, kMostSide));
}

}  // namespace

EventCollector::EventCollector(cv::Size sensor)
    : sensor_(sensor), pixels_(counted_area(sensor)), flicker_(counted_area(sensor)) {}

void EventCollector::add(std::span<const Event> events, std::size_t every) {
  count(events);
  std::size_t next = every - 1 - std::min(skipped_, every - 1);
  for (; next < events.size(); next += every) {
    const Event& event = events[next];
    ++events_;
    positive_ += event.positive;
    extent_.width = std::max(extent_.width, event.x + 1);
    extent_.height = std::max(extent_.height, event.y + 1);
    pixels_.add(event.x, event.y, event.t);
    flicker_.add(event);
  }
  skipped_ = events.size() + every - 1 - next;
}

void EventCollector::count(std::span<const Event> events) {
  while (!events.empty()) {
    const Timestamp t = events.front().t;
    if (bin_end_ == Timestamp::min()) bin_end_ = t + kBin;
    if (t >= bin_end_) {
      const Duration::rep bins = (t - bin_end_) / kBin + 1;
      rates_.close(static_cast<std::size_t>(bins));
      bin_end_ += bins * kBin;
    }
    const auto later = std::ranges::lower_bound(events, bin_end_, {}, &Event::t);
    rates_.bin_events += static_cast<std::size_t>(later - events.begin());
    events = {later, events.end()};
  }
}

void EventCollector::Rates::close(std::size_t ended) {
  const double rate = static_cast<double>(bin_events) / to_seconds(kBin);
  const auto band = std::ranges::upper_bound(EventStatistics::kRateBands, rate) - EventStatistics::kRateBands.begin();
  ++band_bins[static_cast<std::size_t>(band)];
  band_bins[0] += ended - 1;
  peak = std::max(peak, std::exchange(bin_events, 0));
  bins += ended;
}

EventStatistics EventCollector::result() const {
  Rates rates = rates_;
  if (rates.bin_events > 0) rates.close(1);
  EventStatistics statistics;
  statistics.positive_share = share(positive_, events_);
  statistics.peak_rate_hz = static_cast<double>(rates.peak) / to_seconds(kBin);
  for (std::size_t i = 0; i < statistics.rate_shares.size(); ++i)
    statistics.rate_shares[i] = share(rates.band_bins[i], rates.bins);
  statistics.extent = extent_;
  statistics.active_share = share(pixels_.active(), area(sensor_.empty() ? extent_ : sensor_));
  statistics.hot_known = pixels_.known();
  statistics.hottest = pixels_.result();
  statistics.hot_pixels = statistics.hottest.size();
  std::size_t hot_events = 0;
  for (const HotPixel& pixel : statistics.hottest) hot_events += pixel.events;
  statistics.hot_share = share(hot_events, events_);
  statistics.flicker = flicker_.result();
  statistics.hottest.resize(std::min(statistics.hottest.size(), kListedHotPixels));
  return statistics;
}

}  // namespace edged
