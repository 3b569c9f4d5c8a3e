// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the event frames that are no options: unit, effect, and where each value comes from.
#pragma once

#include <chrono>

#include "edged/time.hpp"

namespace edged {

/// Decisions are those of docs/decisions.
struct EventsTuning {
  // Warp (decision 001).
  Duration warp_step = std::chrono::microseconds(500);  ///< between exact homographies: below 0.02 px off at 20 rad/s
  int cell_px = 8;               ///< within which depth and direction of the image motion hardly change
  double depth_reach_px = 40.0;  ///< cells farther from every landmark have the depth of the scene

  // Enhancement (Algorithm 1).
  int clahe_tiles = 4;            ///< tiles of the equalization in each direction
  double unsharp_sigma_px = 2.0;  ///< blur of unsharp masking

  // Event frames that are expected of frames (decision 041), in grey levels.
  double added_grey = 10.0;  ///< below it the logarithm shows noise
  double frame_blur_px = 1.0;
  double mean_grey = 32.0;  ///< mean of the result

  // Flicker (decision 044). Recordings without lamps reach a swing of 0.22 and powers of 53 and 57 at once (a hand), or
  // 0.05, 127 and 95 (stripes); a lamp has 0.46, 4000 and 4000.
  double lamp_min_hz = 60.0, lamp_max_hz = 900.0;
  double lamp_min_events = 500.0;       ///< in a window
  double lamp_min_swing = 0.08;         ///< swing of the polarities
  double lamp_min_power_ratio = 100.0;  ///< over as many random events, and over the median of all frequencies
  int lamp_missed_windows = 2;          ///< until it counts as gone
  double lamp_reach = 0.9;              ///< [cycles]: an event returns from the half cycle before it
  /// Events of a pixel within the reach for each one beyond those that return: thresholds of rise and fall differ, and
  /// so do the events of both directions.
  int lamp_events_per_surplus = 4;
};
inline constexpr EventsTuning kEventsTuning;

}  // namespace edged
