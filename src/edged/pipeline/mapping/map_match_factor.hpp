// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A map match as a factor of the final optimization: a map point, which moves with its keyframe, in a later image.
#pragma once

#include <optional>

#include "edged/estimator/factors/factor.hpp"
#include "edged/map/map_errors.hpp"

namespace edged {

/// The image of a map match: at a step T_A_B of the odometry from a state.
struct MatchedImage {
  StateId state;
  SE3 T_A_B, T_B_C;
};

/// The keyframe of a map point: a state of the same start, or a pose that is known.
struct MatchedKeyframe {
  std::optional<StateId> state;
  SE3 T_O_K;
};

/// Blocks: pose of the image's state, then that of the keyframe if it is none that is known. Residual (2): predicted
/// minus observed position, over the noise of the match and of the point's depth as of the first values. `share`: of
/// one observation, for which all matches of a point count together.
class MapMatchFactor final : public Factor {
 public:
  /// whiten: the root of the information, R^-1/2.
  MapMatchFactor(const MatchedImage& image, const MatchedKeyframe& keyframe, const MapObservation& observation,
                 const Eigen::Matrix2d& whiten, double share);
  const ceres::LossFunction* loss() const override { return &loss_; }
  bool Evaluate(double const* const* values, double* residuals, double** jacobians) const override;

 private:
  SE3 T_A_B_, T_B_C_, T_O_K_;
  MapObservation observation_;
  Eigen::Matrix2d whiten_;
  ceres::ScaledLoss loss_;
};

}  // namespace edged
