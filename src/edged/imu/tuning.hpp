// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the IMU that were chosen, not derived: each with its unit, its effect and its reason. A number in
// brackets names the decision page (docs/decisions).
#pragma once

#include <array>
#include <cstddef>

#include "edged/time.hpp"

namespace edged {

/// Knocks and gaps [022].
struct ImuTuning {
  double jump_share = 0.3;                               ///< share of a jump beyond the usual that is uncertain
  double usual_gyro_jump = 1.0, usual_accel_jump = 4.0;  ///< [rad/s], [m/s^2] between two samples of a body in flight
  /// Process noise in a gap, where the motion is assumed to continue: rates of 1.5 rad/s and accelerations of 5 m/s^2
  /// that last for 0.1 s, as densities [rad/s/sqrt(Hz)], [m/s^2/sqrt(Hz)].
  double gap_gyro_noise = 0.7, gap_accel_noise = 2.2;
};
inline constexpr ImuTuning kImuTuning{};

/// The noise in use [022].
struct ImuNoiseTuning {
  Duration window = std::chrono::milliseconds(1000);     ///< of samples: the noise follows motors within half of it
  Duration max_spacing = std::chrono::milliseconds(50);  ///< of samples; a longer gap begins anew
  double short_block_s = 0.003, middle_block_s = 0.01;  ///< [s] too short for motion of the body, as are single samples
  double long_block_s = 0.025;                          ///< [s] near the interval between states
  std::size_t min_blocks = 9;                           ///< six third differences
  double significant = 1.5;                             ///< times the calibrated density: less is its own scatter
  std::size_t min_corrections = 8;                      ///< of the velocity within the window
  double max_growth = 10.0;                             ///< of the noise by them: motors vary by some Hz
  std::array<double, 3> rest_blocks_s = {0.05, 0.1, 0.2};  ///< [s] of means at rest: the intervals between states
  std::size_t min_rest_blocks = 4;                         ///< in a rest, else such means are too few
  double significant_at_rest = 2.0;                        ///< as above, of the largest of three
};
inline constexpr ImuNoiseTuning kImuNoiseTuning{};

/// What a working sensor does not give [022].
struct ImuGateTuning {
  double gyro_range = 70.0, accel_range = 314.0;  ///< [rad/s], [m/s^2] twice the range of common sensors
  double beyond_largest = 4.0;                    ///< times the largest so far, where the unit may be another one
  double any_unit = 1e6;                          ///< beyond any sensor in any unit
  double times_usual_jump = 8.0;                  ///< a spike exceeds so many usual differences, and usual_gyro_jump
  double returned = 0.25;     ///< share of a spike within which the next sample is back; a knock rings with 0.7
  std::size_t window = 64;    ///< neighbours from which the share of equal ones is learnt, and its memory of jumps
  double least_share = 0.15;  ///< equal neighbours at rest of a sensor that has been seen in motion only
  double rest_steps = 2.5;    ///< changes of the resolution up to which a sensor may rest
  double suspected = 3.0;     ///< surprise beyond which samples are held: one in 20
  double refused = 16.0;      ///< surprise that chance does not explain: one in 10 million
  std::size_t most_of_burst = 1000;  ///< samples with one stamp
};
inline constexpr ImuGateTuning kImuGateTuning{};

}  // namespace edged
