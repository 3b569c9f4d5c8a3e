// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Statistics of events: rates, times and pixels.
#pragma once

#include <array>
#include <opencv2/core/types.hpp>
#include <optional>
#include <span>
#include <vector>

#include "edged/checks/statistics/flicker_statistics.hpp"
#include "edged/checks/statistics/hot_pixels.hpp"
#include "edged/measurement.hpp"

namespace edged {

struct EventStatistics {
  /// Upper ends of the bands of the rate histogram [events/s]; the last band is open.
  static constexpr std::array<double, 5> kRateBands = {1e3, 1e4, 1e5, 1e6, 1e7};

  double positive_share = 0.0;                              ///< share of all events
  double peak_rate_hz = 0.0;                                ///< over 10 ms
  std::array<double, kRateBands.size() + 1> rate_shares{};  ///< shares of the time in each band
  double active_share = 0.0;                                ///< share of the pixels that fired at all
  cv::Size extent;                                          ///< the smallest sensor that contains all events [px]
  bool hot_known = true;  ///< false if the recording is too short to detect hot pixels
  std::size_t hot_pixels = 0;
  double hot_share = 0.0;         ///< share of the events from hot pixels
  std::vector<HotPixel> hottest;  ///< at most ten, hottest first
  std::optional<FlickerStatistics> flicker;
};

/// Events must be in time order. Memory: that of HotPixelFinder and FlickerCollector, at most 109 MB, none before the
/// first event.
class EventCollector {
 public:
  /// sensor: events beyond it are counted, but not per pixel; empty if unknown.
  explicit EventCollector(cv::Size sensor);

  /// every: pixels, polarities and flicker of each n-th event only, which is cheaper; their shares and frequencies
  /// remain the same, the rates of hot pixels are n times lower.
  void add(std::span<const Event> events, std::size_t every = 1);
  EventStatistics result() const;

 private:
  /// Event rates of the whole image, over bins of 10 ms.
  struct Rates {
    std::size_t bin_events = 0, bins = 0, peak = 0;
    std::array<std::size_t, EventStatistics::kRateBands.size() + 1> band_bins{};
    /// Ends the current bin. The remaining ones are empty.
    void close(std::size_t ended);
  };
  void count(std::span<const Event> events);

  cv::Size sensor_, extent_;
  HotPixelFinder pixels_;
  FlickerCollector flicker_;
  std::size_t skipped_ = 0;                // since the last one whose pixel was counted
  std::size_t events_ = 0, positive_ = 0;  // whose pixels were counted
  Rates rates_;
  Timestamp bin_end_ = Timestamp::min();
};

}  // namespace edged
