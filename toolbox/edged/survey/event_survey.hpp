// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Statistics of events: rates, times and pixels.
#pragma once

#include <array>
#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/survey/hot_pixels.hpp"

namespace edged {

struct EventSurvey {
  /// Upper ends of the bands of the rate histogram [events/s]; the last band is open.
  static constexpr std::array<double, 5> kRateBands = {1e3, 1e4, 1e5, 1e6, 1e7};

  double positive_share = 0.0;                              ///< of all events
  double peak_rate_hz = 0.0;                                ///< over 10 ms
  std::array<double, kRateBands.size() + 1> rate_shares{};  ///< of the time, by band
  double active_share = 0.0;                                ///< pixels that fired at all, of the sensor
  cv::Size extent;                                          ///< the least sensor that holds every event [px]
  bool hot_known = true;  ///< false for a recording that is too short to detect hot pixels
  std::size_t hot_pixels = 0;
  double hot_share = 0.0;         ///< events of hot pixels, of all
  std::vector<HotPixel> hottest;  ///< at most ten, hottest first
};

/// Takes events in time order. Memory: that of HotPixelFinder, 92 MB at most.
class EventSurveyor {
 public:
  /// sensor: pixels beyond it are counted, but not one by one; empty where it is not known.
  explicit EventSurveyor(cv::Size sensor);

  void add(std::span<const Event> events);
  EventSurvey result() const;

 private:
  void close_bin(std::size_t bins);

  cv::Size sensor_, extent_;
  HotPixelFinder pixels_;
  std::size_t events_ = 0, positive_ = 0, bin_events_ = 0, bins_ = 0, peak_ = 0;
  std::array<std::size_t, EventSurvey::kRateBands.size() + 1> band_bins_{};
  Timestamp bin_end_ = Timestamp::min();
};

}  // namespace edged
