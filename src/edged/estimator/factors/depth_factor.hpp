// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The depth factor (paper Eq. 5): the middle of what landmarks say of a region's inverse depth against what another
// source says of it, up to that source's scale.
#pragma once

#include <ceres/cost_function.h>

#include <cstddef>
#include <vector>

#include "edged/options/estimator.hpp"
#include "edged/se3.hpp"

namespace edged {

/// A landmark as the factor sees it.
struct DepthLandmark {
  SE3 T_B_C;                     ///< of the camera that tracks it
  Eigen::Vector2d anchor_point;  ///< on that camera's unit plane, in the anchor view
  std::size_t anchor = 0;        ///< which of the factor's pose blocks the anchor is; 0: the observing state itself
};

/// Blocks: ln s; the pose of the observing state, then those of the other anchors; the inverse depth of each landmark
/// in its anchor camera. With z_i the landmark's depth in the observing camera E, rho_bar is the mean of 1/z_i and ln
/// rho_bar that of ln 1/z_i. Residual (1): weight times the chosen difference. Fails when a landmark is not in front.
class DepthFactor final : public ceres::CostFunction {
 public:
  DepthFactor(DepthResidual residual, const SE3& T_B_E, std::vector<DepthLandmark> landmarks, std::size_t poses,
              double source_depth_m, double weight);
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  DepthResidual residual_;
  Eigen::Vector3d t_B_E_, z_E_in_B_;
  std::vector<DepthLandmark> landmarks_;
  std::size_t poses_;
  double rho_source_, weight_;
};

}  // namespace edged
