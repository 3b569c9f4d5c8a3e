// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The visual factor: a landmark, with an inverse depth in its anchor view, observed in other views: of the same camera
// at other states, or of other cameras.
//
// A landmark has many views, and a view many landmarks: terms of one of the two alone are computed once (CameraAt,
// AnchoredLandmark, LandmarkDerivatives), only the rest for each observation.
#pragma once

#include <Eigen/Core>

#include "edged/estimator/factors/blocks.hpp"
#include "edged/se3.hpp"

namespace edged {

/// The motion of the body at the instant of a state. It converts a shift of the camera clock into one of the camera
/// pose.
struct BodyRate {
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d v_O = Eigen::Vector3d::Zero();      ///< [m/s]
};

/// A point of an image as a linear function of the corrections of the intrinsics.
struct ImagePoint {
  Eigen::Vector2d at_zero = Eigen::Vector2d::Zero();  ///< on the unit plane
  ByIntrinsics by_intrinsics = ByIntrinsics::Zero();
};

/// T_O_C of a camera whose image was taken `time` after the state: T_O_B extrapolated by the rate, then T_B_C rotated
/// by phi and shifted by the lever arm's correction. calibration: a CalibrationBlock's numbers.
SE3 camera_pose(const SE3& T_O_B, const BodyRate& rate, const SE3& T_B_C, const double* calibration);

/// A camera on the body, its calibration applied.
struct CameraOnBody {
  /// calibration: a CalibrationBlock's numbers.
  CameraOnBody(const SE3& T_B_C, const double* calibration);
  Eigen::Matrix3d R_B_C;
  Eigen::Vector3d t_B_C;
  Eigen::Vector2d corrected(const ImagePoint& point) const {
    return point.at_zero + point.by_intrinsics.lazyProduct(intrinsics);
  }

  Eigen::Matrix3d by_phi;  ///< right Jacobian at phi: a change of phi as a rotation of the camera
  double time;             ///< time of its image after the state [s]
  IntrinsicsCorrection intrinsics;
};

/// A camera at one state's image. The rate is a constant: its error enters only times the time shift.
struct CameraAt {
  CameraAt(const CameraOnBody& camera, const SE3& T_O_B, const BodyRate& rate);
  Eigen::Matrix3d R_O_B;  ///< rotation of the body at the image's time
  Eigen::Matrix3d R_C_O;
  Eigen::Vector3d p_O_C;
  Eigen::Matrix3d by_turn;  ///< a rotation of the body at the state as one at the time of the image
  BodyRate rate;
};

/// A camera and its pose. Both must outlive this.
struct CameraView {
  const CameraOnBody& camera;
  const CameraAt& at;
};

/// e = predicted - observed on the unit plane, and its derivatives by the tangents of the blocks.
struct ObservationError {
  Eigen::Vector2d e = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> by_anchor, by_seen;  ///< poses of the anchor's state and of the observing one
  /// Calibrations of the anchor's camera and of the observing one; if these are the same, all is in the first, and the
  /// second is not set.
  Eigen::Matrix<double, 2, kCalibrationSize> by_anchor_calibration, by_seen_calibration;
  Eigen::Vector2d by_rho;
};

/// A landmark in its anchor view. Everything is scaled by the inverse z-depth rho there [1/m], so that points at
/// infinity (rho = 0) are ordinary points.
struct AnchoredLandmark {
  /// point: in the anchor view; must outlive this.
  AnchoredLandmark(const CameraView& anchor, const ImagePoint& point, double rho);

  /// e = predicted - observed, of an observation at `point` of the camera `seen`. False when the landmark is not in
  /// front of it.
  bool error(const CameraView& seen, const ImagePoint& point, Eigen::Vector2d& e) const;

  Eigen::Vector3d in_camera(const CameraAt& seen) const {
    return seen.R_C_O * (bearing_O + rho * (anchor.p_O_C - seen.p_O_C));
  }

  const CameraOnBody& camera;
  const CameraAt& anchor;
  double rho;
  Eigen::Vector3d bearing_C, bearing_O;
  const ByIntrinsics& by_intrinsics;  ///< derivatives of bearing_C's first two numbers
};

/// The common part of the derivatives of all observations of a landmark: that of its position in O, times rho, by the
/// anchor's rotation, phi, the time, the lever arm and the intrinsics.
class LandmarkDerivatives {
 public:
  /// The landmark must outlive this. rho: its inverse depth, or that at which translations count [1/m].
  LandmarkDerivatives(const AnchoredLandmark& landmark, double rho);
  /// As AnchoredLandmark::error, with derivatives.
  bool error(const CameraView& seen, const ImagePoint& point, ObservationError& observation) const;

 private:
  const AnchoredLandmark& landmark_;
  double rho_;
  Eigen::Matrix3d by_turn_, by_phi_;
  Eigen::Vector3d by_time_;
  Eigen::Matrix<double, 3, kIntrinsics> by_intrinsics_;
};

}  // namespace edged
