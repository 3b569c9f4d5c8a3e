// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects the hot pixels of an event camera.
#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "edged/time.hpp"

namespace edged {

/// A pixel that fires independently of the scene.
struct HotPixel {
  int x = 0, y = 0;
  std::size_t events = 0;  ///< in the whole recording, including those of the scene
  double rate_hz = 0.0;    ///< beyond the rate of its neighbours
};

/// A hot pixel fires in each time window, with or without its neighbours. Its excess is averaged over all windows.
/// Windows with few events have a larger weight, as the scene has less influence there.
class HotPixelFinder {
 public:
  static constexpr double kLeastHz = 5.0;  ///< lower rates are harmless

  /// Needs 22 bytes per pixel of `grid`, from the first event on. Pixels outside are ignored.
  explicit HotPixelFinder(cv::Size grid) : grid_(grid) {}

  /// Stamps must not decrease.
  void add(int x, int y, Timestamp t) {
    if (x >= grid_.width || y >= grid_.height) return;
    if (t >= window_end_) end_window(t);
    ++events_;
    std::uint16_t& count = window_[place(x, y)];
    if (count < UINT16_MAX) ++count;
    ++total_[place(x, y)];
    extent_.width = std::max(extent_.width, x + 1);
    extent_.height = std::max(extent_.height, y + 1);
    last_ = t;
  }

  /// The hot pixels, hottest first. None before two windows have passed, unless one pixel has more than 1 % of all
  /// events.
  std::vector<HotPixel> result() const;
  /// False if the recording is too short.
  bool known() const { return first_ != Timestamp::min() && last_ - first_ >= kWindow * 3 / 2; }
  /// The number of pixels that fired at all.
  std::size_t active() const;

 private:
  /// Sums of a weighted mean of events per second beyond the neighbours, of variance 1 / weight.
  struct Excess {
    float sum = 0.0F, weight = 0.0F;
    float most_sum = 0.0F, most_weight = 0.0F;  ///< the window with the largest contribution
    double without_most_hz() const { return weight > most_weight ? (sum - most_sum) / (weight - most_weight) : 0.0; }
  };
  static constexpr Duration kWindow = std::chrono::milliseconds(500);

  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width) + static_cast<std::size_t>(x);
  }
  void end_window(Timestamp t);
  /// Excess of a pixel, if a window of that length ended now.
  Excess excess_with_window(int x, int y, double seconds) const;
  int neighbours(int x, int y) const;

  cv::Size grid_, extent_, judged_;  ///< judged_: extent_ at the last window
  float silent_weight_ = 0.0F;       ///< weight of a pixel without events of its own and of its neighbours so far
  std::vector<std::uint32_t> total_;
  std::vector<std::uint16_t> window_;
  std::vector<Excess> excess_;
  Timestamp window_end_ = Timestamp::min(), first_ = Timestamp::min(), last_ = Timestamp::min();
  std::size_t events_ = 0;
};

}  // namespace edged
