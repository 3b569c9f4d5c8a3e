// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the camera models that were chosen, not derived, each with its unit, effect and reason. A number in
// brackets names the decision page (docs/decisions).
#pragma once

#include <numbers>

#include "edged/core/angles.hpp"

namespace edged {

struct CameraTuning {
  /// Angles off the axis [rad]. A lens that reaches more than `widest` is used only up to `used_of_wider`: a pixel at
  /// 70 degrees is 4.4 times as long on the unit plane as on the axis, at 80 degrees 12 times [015].
  double widest = 86.0 * kDegree, used_of_wider = 70.0 * kDegree;
  double unit_plane_end = 89.0 * kDegree;  ///< [rad] off the axis, where points of the unit plane end
  double scan_step = 0.05 * kDegree;       ///< [rad] of the search for the angle where a distortion turns back
  /// A lens that turns back before the corners is used where it is at least this steep, relative to the axis, if that
  /// leaves this share of the image. A wrong order of the coefficients leaves less.
  double min_slope = 0.25, min_share = 0.75;
  double widest_pinhole = std::numbers::sqrt3;  ///< half a side of the ideal pinhole of a wide lens, on the unit plane:
                                                ///< 120 degrees; more would leave too few pixels to its middle [015]
  double min_baseline_m = 0.01;                 ///< nearer cameras see no depth together: they are taken for one lens
};
inline constexpr CameraTuning kCameraTuning{};

}  // namespace edged
