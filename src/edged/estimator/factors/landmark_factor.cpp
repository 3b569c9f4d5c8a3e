// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/landmark_factor.hpp"

#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix23 = Eigen::Matrix<double, 2, 3>;

/// A body pose extrapolated at its rate.
SE3 moved_body(const SE3& T_O_B, const BodyRate& rate, double time) {
  return {T_O_B.rotation() * so3::exp(rate.omega_B * time), T_O_B.translation() + rate.v_O * time};
}

}  // namespace

SE3 camera_pose(const SE3& T_O_B, const BodyRate& rate, const SE3& T_B_C, const double* calibration) {
  const Eigen::Map<const Vector3d> phi(calibration);
  const Eigen::Map<const Vector3d> lever_arm(calibration + kLeverArmAt);
  return moved_body(T_O_B, rate, calibration[kTimeAt]) *
         SE3(T_B_C.rotation() * so3::exp(phi), T_B_C.translation() + lever_arm);
}

CameraOnBody::CameraOnBody(const SE3& T_B_C, const double* calibration)
    : R_B_C((T_B_C.rotation() * so3::exp(Vector3d(calibration))).toRotationMatrix()),
      t_B_C(T_B_C.translation() + Eigen::Map<const Vector3d>(calibration + kLeverArmAt)),
      by_phi(so3::right_jacobian(Vector3d(calibration))),
      time(calibration[kTimeAt]),
      intrinsics(calibration + kIntrinsicsAt) {}

CameraAt::CameraAt(const CameraOnBody& camera, const SE3& T_O_B, const BodyRate& rate_in)
    : by_turn(so3::exp(rate_in.omega_B * -camera.time).toRotationMatrix()), rate(rate_in) {
  const SE3 T_O_moved = moved_body(T_O_B, rate, camera.time);
  R_O_B = T_O_moved.R();
  R_C_O = (R_O_B * camera.R_B_C).transpose();
  p_O_C = T_O_moved.translation() + R_O_B * camera.t_B_C;
}

AnchoredLandmark::AnchoredLandmark(const CameraView& view, const ImagePoint& point, double rho_in)
    : camera(view.camera),
      anchor(view.at),
      rho(rho_in),
      bearing_C(camera.corrected(point).homogeneous()),
      bearing_O(anchor.R_C_O.transpose() * bearing_C),
      by_intrinsics(point.by_intrinsics) {}

bool AnchoredLandmark::error(const CameraView& seen, const ImagePoint& point, Vector2d& e) const {
  const Vector3d x_C = in_camera(seen.at);
  if (x_C.z() < kFactorTuning.min_depth_share) return false;
  e = x_C.head<2>() / x_C.z() - seen.camera.corrected(point);
  return true;
}

LandmarkDerivatives::LandmarkDerivatives(const AnchoredLandmark& landmark, double rho)
    : landmark_(landmark), rho_(rho) {
  const CameraAt& anchor = landmark.anchor;
  const Vector3d x_B = landmark.camera.R_B_C * landmark.bearing_C + rho * landmark.camera.t_B_C;
  by_turn_ = -anchor.R_O_B * skew(x_B) * anchor.by_turn;
  by_phi_ = -anchor.R_C_O.transpose() * skew(landmark.bearing_C);
  by_time_ = anchor.R_O_B * anchor.rate.omega_B.cross(x_B) + rho * anchor.rate.v_O;
  by_intrinsics_ = anchor.R_C_O.topRows<2>().transpose() * landmark.by_intrinsics;
}

bool LandmarkDerivatives::error(const CameraView& view, const ImagePoint& point, ObservationError& observation) const {
  const double rho = rho_;
  const CameraOnBody& camera = view.camera;
  const CameraAt& seen = view.at;
  const Vector3d x_C = landmark_.in_camera(seen);
  if (x_C.z() < kFactorTuning.min_depth_share) return false;
  const double z_inv = 1.0 / x_C.z();
  const Vector2d predicted = x_C.head<2>() * z_inv;
  observation.e = x_C.head<2>() / x_C.z() - camera.corrected(point);  // bit-identical to AnchoredLandmark::error

  Matrix23 by_xC;
  by_xC << z_inv, 0, -predicted.x() * z_inv, 0, z_inv, -predicted.y() * z_inv;
  const Matrix23 by_xW = by_xC * seen.R_C_O, by_xB = by_xW * seen.R_O_B;
  const Vector3d x_B = camera.R_B_C * x_C + rho * camera.t_B_C;
  observation.by_anchor.leftCols<3>() = rho * by_xW;
  observation.by_anchor.rightCols<3>() = by_xW * by_turn_;
  observation.by_seen.leftCols<3>() = -rho * by_xW;
  observation.by_seen.rightCols<3>() = by_xB * skew(x_B) * seen.by_turn;
  const Matrix23 arm_anchor = rho * by_xW * landmark_.anchor.R_O_B, arm_seen = -rho * by_xB;
  if (&camera == &landmark_.camera) {
    auto& by = observation.by_anchor_calibration;
    by.leftCols<3>() = (by_xC * skew(x_C) + by_xW * by_phi_) * camera.by_phi;
    by.col(kTimeAt) = by_xW * (by_time_ - rho * seen.rate.v_O) - by_xB * seen.rate.omega_B.cross(x_B);
    by.middleCols<3>(kLeverArmAt) = arm_anchor + arm_seen;
    by.rightCols<kIntrinsics>() = by_xW * by_intrinsics_ - point.by_intrinsics;
  } else {
    auto &by = observation.by_anchor_calibration, &by_seen = observation.by_seen_calibration;
    by.leftCols<3>() = by_xW * by_phi_ * landmark_.camera.by_phi;
    by.col(kTimeAt) = by_xW * by_time_;
    by.middleCols<3>(kLeverArmAt) = arm_anchor;
    by.rightCols<kIntrinsics>() = by_xW * by_intrinsics_;
    by_seen.leftCols<3>() = by_xC * skew(x_C) * camera.by_phi;
    by_seen.col(kTimeAt) = -by_xW * (rho * seen.rate.v_O) - by_xB * seen.rate.omega_B.cross(x_B);
    by_seen.middleCols<3>(kLeverArmAt) = arm_seen;
    by_seen.rightCols<kIntrinsics>() = -point.by_intrinsics;
  }
  observation.by_rho = by_xW * (landmark_.anchor.p_O_C - seen.p_O_C);
  return true;
}

}  // namespace edged
