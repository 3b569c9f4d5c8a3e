// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The visual factor: a landmark, held as inverse depth in its anchor view, seen from another state by the same camera.
#pragma once

#include <ceres/sized_cost_function.h>

#include "edged/core/lie.hpp"

namespace edged {

/// Blocks: pose of the anchor state, pose of the observing state, inverse z-depth in the anchor camera [1/m].
/// Residual (2): (predicted - seen) / sigma on the unit plane of the camera. Fails (Ceres rejects the step) when the
/// landmark is not in front of the observing camera.
class ReprojectionFactor final : public ceres::SizedCostFunction<2, 7, 7, 1> {
 public:
  ReprojectionFactor(const SE3& T_B_C, const Eigen::Vector2d& anchor_point, const Eigen::Vector2d& seen_point,
                     double sigma)
      : T_B_C_(T_B_C), anchor_(anchor_point.x(), anchor_point.y(), 1.0), seen_(seen_point), weight_(1.0 / sigma) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  SE3 T_B_C_;
  Eigen::Vector3d anchor_;
  Eigen::Vector2d seen_;
  double weight_;
};

}  // namespace edged
