// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The transform between the world of an estimate and the world of the ground truth, in the least-squares sense.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "edged/eval/association.hpp"

namespace edged {

enum class AlignmentKind {
  None,
  PositionYaw,  ///< 4 degrees of freedom: those unobservable in a visual-inertial estimate
  SE3,
  Sim3,  ///< SE(3) and a scale
};
std::string to_string(AlignmentKind kind);

/// x_truth = scale * R * x_estimate + t with (R, t) = T.
struct Similarity {
  double scale = 1.0;
  SE3 T;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return scale * (T.rotation() * point) + T.translation();
  }
  /// Only the position of a pose is scaled.
  SE3 operator*(const SE3& pose) const { return {T.rotation() * pose.rotation(), *this * pose.translation()}; }
};

/// Seconds since the first pair, both ends included.
struct TimeWindow {
  double begin_s = 0.0;
  double end_s = std::numeric_limits<double>::infinity();

  bool operator==(const TimeWindow&) const = default;
};

/// The pairs inside the window.
std::vector<PosePair> within(const std::vector<PosePair>& pairs, const TimeWindow& window);

/// Least squares over the positions: Umeyama, "Least-squares estimation of transformation parameters between two point
/// patterns" (1991), Eq. 40-42; its yaw-only counterpart in closed form. Throws InputError when there are fewer than
/// three pairs, or when the positions do not fix the rotation (all on one point or line).
Similarity align(const std::vector<PosePair>& pairs, AlignmentKind kind);

/// SE(3) in the same sense, where the positions need not determine it: at rest or on a line it is one of the best. At
/// least one pair.
Similarity align_rigidly(const std::vector<PosePair>& pairs);

/// Mean squared error of the aligned positions, over all pairs [m^2].
double mean_squared_error(const std::vector<PosePair>& pairs, const Similarity& alignment);

}  // namespace edged
