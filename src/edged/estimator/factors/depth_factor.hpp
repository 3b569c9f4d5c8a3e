// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The depth factor (paper Eq. 5): the mean inverse depth of landmarks in a region against that of another source, up to
// the scale of the source.
#pragma once

#include <cstddef>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/options/estimator.hpp"
#include "edged/se3.hpp"

namespace edged {

/// A landmark in the factor.
struct DepthLandmark {
  std::uint64_t id = 0;          ///< FeatureId
  SE3 T_B_C;                     ///< pose of the anchor camera
  Eigen::Vector2d anchor_point;  ///< on that camera's unit plane, in the anchor view
  StateId anchor = 0;
};

/// The depth of a region in a camera at a state, as measured by a source.
struct DepthMeasurement {
  DepthResidual residual;
  StateId state;
  SE3 T_B_E;  ///< pose of the observing camera
  double source_depth_m;
  double weight;
};

/// Blocks: ln s; the pose of the observing state, then those of the other anchors; the inverse depth of each landmark
/// in its anchor camera. With z_i the landmark's depth in the observing camera E, rho_bar is the mean of 1/z_i and ln
/// rho_bar that of ln 1/z_i. Residual (1): weight times the chosen difference. Fails when a landmark is not in front.
///
/// The window rebuilds it for each cost, from the present landmarks. It goes into the prior with its own state, if all
/// its landmarks are anchored there and are marginalized, too.
class DepthFactor final : public Factor {
 public:
  DepthFactor(const DepthMeasurement& measured, BlockKey scale, std::vector<DepthLandmark> landmarks);
  const ceres::LossFunction* loss() const override { return &loss_; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  bool marginalized_with(const std::set<BlockKey>& leaving) const override;

 private:
  DepthResidual residual_;
  Eigen::Vector3d t_B_E_, z_E_in_B_;
  std::vector<DepthLandmark> landmarks_;
  std::vector<std::size_t> anchor_blocks_;  ///< index of the anchor's pose, by landmark
  std::size_t poses_;
  double rho_source_, weight_;
  ceres::CauchyLoss loss_;
};

}  // namespace edged
