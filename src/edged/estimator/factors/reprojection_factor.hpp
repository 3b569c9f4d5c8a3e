// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The visual factor: a landmark, held as inverse depth in its anchor view, seen from another state by the same camera.
#pragma once

#include <ceres/sized_cost_function.h>

#include "edged/se3.hpp"

namespace edged {

/// How the body moves at the instant of a state: what turns a shift of the camera's clock into one of its pose.
struct BodyRate {
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();      ///< [m/s]
};

/// T_W_C of a camera whose image was taken `time` after the state: T_W_B moved on by the rate, then T_B_C turned by
/// phi. calibration: a CalibrationBlock's numbers.
SE3 camera_pose(const SE3& T_W_B, const BodyRate& rate, const SE3& T_B_C, const double* calibration);

/// One of the views of a landmark. The rate is a constant: what it is off by counts only times the time shift.
struct LandmarkView {
  Eigen::Vector2d point;  ///< on the unit plane
  BodyRate rate;
};

/// Blocks: pose of the anchor state, pose of the observing state, calibration of the camera, inverse z-depth in the
/// anchor camera [1/m]. Residual (2): (predicted - seen) / sigma on the unit plane of the camera. Fails (Ceres rejects
/// the step) when the landmark is not in front of the observing camera.
class ReprojectionFactor final : public ceres::SizedCostFunction<2, 7, 7, 4, 1> {
 public:
  ReprojectionFactor(const SE3& T_B_C, const LandmarkView& anchor, const LandmarkView& seen, double sigma)
      : T_B_C_(T_B_C), anchor_(anchor), seen_(seen), weight_(1.0 / sigma) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  SE3 T_B_C_;
  LandmarkView anchor_, seen_;
  double weight_;
};

/// The same for an observation whose error is in part that of the observation before it: a track that has drifted stays
/// where it is. Blocks: poses of the anchor, the observing state and the state of the observation before, then as
/// above. Residual (2): (e - correlation * e_before) / sigma with e = predicted - seen of either; sigma: of what the
/// observation before does not tell.
class TrackStepFactor final : public ceres::SizedCostFunction<2, 7, 7, 7, 4, 1> {
 public:
  TrackStepFactor(const SE3& T_B_C, const LandmarkView& anchor, const LandmarkView& seen, const LandmarkView& before,
                  double correlation, double sigma)
      : T_B_C_(T_B_C), anchor_(anchor), seen_(seen), before_(before), correlation_(correlation), weight_(1.0 / sigma) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  SE3 T_B_C_;
  LandmarkView anchor_, seen_, before_;
  double correlation_, weight_;
};

}  // namespace edged
