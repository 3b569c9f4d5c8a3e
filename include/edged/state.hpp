// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is estimated: poses, the state of the body, landmarks. Frames: O odometry (of one start of the estimator), M
// map, B body, C camera; M and O have z up. In the public interface W (world) is another name of M.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

struct StampedPose {
  Timestamp t;
  SE3 T;  ///< the user of a trajectory says which two frames
};

using Trajectory = std::vector<StampedPose>;

/// The state of the body B in the world W (z up) at one instant.
struct NavState {
  Timestamp t;  ///< IMU clock
  SE3 T_W_B;
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();         ///< velocity of B in W [m/s]
  Eigen::Vector3d bias_gyro = Eigen::Vector3d::Zero();   ///< [rad/s], measured = true + bias
  Eigen::Vector3d bias_accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Covariance of a state relative to the first start of the estimator, where position and yaw are exact by definition.
/// After a loss it contains what the motion until the next start leaves uncertain; after relocalization it is relative
/// to the map at that place. The parts are the diagonal blocks of the joint covariance.
struct StateCovariance {
  Eigen::Matrix3d position;  ///< [m^2], in W
  Eigen::Matrix3d rotation;  ///< [rad^2], in B: of phi in R_true = R Exp(phi)
  Eigen::Matrix3d velocity;  ///< [m^2/s^2], in W
};

/// The attitude of the body where no more is known: before the start of the estimator, by gyro and accelerometer. The
/// heading is relative to the first measurement, and drifts.
struct Attitude {
  Eigen::Quaterniond R_W_B = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< [rad^2], in B: of phi in R_true = R Exp(phi)
};

/// Names one feature for as long as it is tracked; never reused, unique over all cameras.
using FeatureId = std::uint64_t;

/// A point of the world that the estimator has placed by the observations of a feature.
struct Landmark {
  FeatureId id = 0;  ///< id of the feature
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
};

/// Logarithm of the scale s of a depth source (paper Eq. 5): its depths are too large by the factor s.
struct LogScale {
  double value = 0.0, sigma = 0.0;
};

/// Magnitude of gravity [m/s^2], and gravity in W.
inline constexpr double kGravity = 9.81;
inline const Eigen::Vector3d kGravity_W(0.0, 0.0, -kGravity);

}  // namespace edged
