// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Flicker of lamps in the events of a recording.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "edged/events/flicker.hpp"

namespace edged {

struct FlickerStatistics {
  double hz = 0.0;           ///< frequency of the light, the mean over the time with flicker
  double time_share = 0.0;   ///< share of the recording
  double event_share = 0.0;  ///< about, of the events in that time
  double image_share = 0.0;  ///< share of the cells with events in that time
};

/// Judges cells of 32 px in each window in which there is flicker. Memory: 4 bytes for each pixel.
class FlickerCollector {
 public:
  /// Events outside of the grid are ignored.
  explicit FlickerCollector(cv::Size grid);

  /// Stamps should not decrease.
  void add(const Event& event) {
    if (event.x >= grid_.width || event.y >= grid_.height) return;
    if (cells_.empty()) make_cells();
    if (detector_.add(event.t, event.positive)) end_window();
    cells_[static_cast<std::size_t>((event.y >> kCellBits) * columns_ + (event.x >> kCellBits))].add(
        detector_.since_begin(event.t), event.positive);
  }
  /// Statistics of the windows that have ended.
  std::optional<FlickerStatistics> result() const;

 private:
  static constexpr int kCellBits = 5;

  void make_cells();
  void end_window();

  cv::Size grid_;
  int columns_;
  FlickerDetector detector_;
  std::vector<PolaritySpectrum> cells_;
  // Sums over the windows with flicker; events by the weight of the spectrum.
  int windows_ = 0, flickering_windows_ = 0;
  double hz_ = 0.0, events_ = 0.0, flicker_events_ = 0.0, cells_seen_ = 0.0, flickering_cells_ = 0.0;
};

}  // namespace edged
