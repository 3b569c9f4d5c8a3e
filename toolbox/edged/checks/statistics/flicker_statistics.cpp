// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/flicker_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

// A cell with fewer events swings by chance.
constexpr double kFewestEvents = 100.0, kLeastSwing = 0.25;
// Of a cell in which all events are of a sine: they gather where it is steep.
constexpr double kFullSwing = 0.8;

}  // namespace

FlickerCollector::FlickerCollector(cv::Size grid) : grid_(grid), columns_((grid.width >> kCellBits) + 1) {}

void FlickerCollector::make_cells() {
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>((grid_.height >> kCellBits) + 1));
}

void FlickerCollector::end_window() {
  ++windows_;
  if (detector_.lamp()) {
    const double hz = detector_.lamp()->hz;
    const auto cycles = static_cast<std::size_t>(std::lround(hz * to_seconds(PolaritySpectrum::kWindow)));
    ++flickering_windows_;
    hz_ += hz;
    for (const PolaritySpectrum& cell : cells_) {
      const double weight = cell.weight();
      events_ += weight;
      if (weight < kFewestEvents) continue;
      const double swing = cell.swing(cycles);
      ++cells_seen_;
      if (swing < kLeastSwing) continue;
      ++flickering_cells_;
      flicker_events_ += weight * std::min(1.0, swing / kFullSwing);
    }
  }
  for (PolaritySpectrum& cell : cells_) cell.clear();
}

std::optional<FlickerStatistics> FlickerCollector::result() const {
  if (flickering_windows_ == 0) return std::nullopt;
  return FlickerStatistics{hz_ / flickering_windows_, static_cast<double>(flickering_windows_) / windows_,
                           flicker_events_ / std::max(1.0, events_), flickering_cells_ / std::max(1.0, cells_seen_)};
}

}  // namespace edged
