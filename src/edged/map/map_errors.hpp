// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Errors of poses in the map M: propagation, and Jacobians of observations of map points. Those of a pose T_M_B
// are (position in M [m], rotation in B [rad]): p_true = p + dp, R_true = R Exp(phi).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "edged/core/angles.hpp"
#include "edged/core/odom_state.hpp"
#include "edged/map/tuning.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"

namespace edged {

/// A map point's observation in an image, predicted or matched. In floats if many are kept.
template <typename Scalar>
struct MapObservationOf {
  using Vector2 = Eigen::Matrix<Scalar, 2, 1>;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

  std::uint32_t keyframe = 0;               ///< number of its keyframe
  Vector3 p_K = Vector3::Zero();            ///< in the body frame of the keyframe
  Vector3 depth_sigma_K = Vector3::Zero();  ///< change of p_K with one sigma of its depth
  Vector2 seen = Vector2::Zero();           ///< on the unit plane of the camera
  Scalar sigma = 0;                         ///< sigma of each coordinate of `seen`
  std::uint32_t camera = 0;                 ///< index of T_B_C of its image

  template <typename Other>
  MapObservationOf<Other> cast() const {
    return {keyframe,
            p_K.template cast<Other>(),
            depth_sigma_K.template cast<Other>(),
            seen.template cast<Other>(),
            static_cast<Other>(sigma),
            camera};
  }
};
using MapObservation = MapObservationOf<double>;

/// A linearized observation: residual, Jacobians by the errors of the body and of its keyframe, and noise.
struct LinearizedObservation {
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 6> by_body, by_keyframe;
  Eigen::Matrix2d R;
};

/// Nothing if the point is behind the camera.
std::optional<LinearizedObservation> linearised(const MapObservation& observation, const SE3& T_M_B, const SE3& T_M_K,
                                                const SE3& T_B_C);

/// Jacobian from the error of T_M_A to that of T_M_A * T_A_B, with T_A_B known.
Matrix6d transport(const SE3& T_M_A, const SE3& T_A_B);

/// Covariance of a rotation error in B with these variances about the vertical and about horizontal axes [rad^2].
Eigen::Matrix3d rotation_covariance(const SE3& T_M_B, double yaw_variance, double tilt_variance);

/// An odometry drifts by the errors of its velocity and of its gyro bias, one after the other (decision 027).
Drift drift_of(const OdomUncertainty& odometry);
/// Covariance of the drift after dt [s].
Matrix6d drift_covariance(const Drift& drift, const SE3& T_M_B, double dt);

/// Up in the body frame by the odometry, a unit vector, and the information on its direction [1/rad^2].
struct GravityObservation {
  Eigen::Vector3d up_B;
  double information;
};
/// dt: the time that it stands for [s]; sigma: of the odometry's tilt [rad], which never drifts, but its error changes
/// slowly.
GravityObservation observed_gravity(const SE3& T_O_B, double dt, double sigma = kMapTuning.tilt_deg * kDegree);

/// The observation of gravity in the normal equations of a pose, H of the Gauss-Newton step and g = J^T W r, by the
/// rotation error alone.
struct LinearizedGravity {
  Eigen::Matrix3d H;
  Eigen::Vector3d g;
};
LinearizedGravity linearised(const GravityObservation& observation, const SE3& T_M_B);

SE3 corrected(const SE3& T, const Vector6d& error);

}  // namespace edged
