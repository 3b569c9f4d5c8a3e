// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Errors of poses in the map M, what they become and what a observation of the map tells of them. Those of a pose T_M_B
// are (position in M [m], rotation in B [rad]): p_true = p + dp, R_true = R Exp(phi).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "edged/options/map.hpp"
#include "edged/se3.hpp"

namespace edged {

/// A point of a keyframe that was found again in an image.
struct MapObservation {
  std::size_t keyframe = 0;                                 ///< by its number where the keyframes are
  Eigen::Vector3d p_K = Eigen::Vector3d::Zero();            ///< in the body frame of the keyframe
  Eigen::Vector3d depth_sigma_K = Eigen::Vector3d::Zero();  ///< by how much p_K moves with one sigma of its depth
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();           ///< on the unit plane of the camera
  double sigma = 0.0;                                       ///< of seen, each coordinate
};

/// Of a observation: residual, Jacobians by the errors of the body and of its keyframe, and noise.
struct LinearizedObservation {
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 6> by_body, by_keyframe;
  Eigen::Matrix2d R;
};

/// Nothing where the point would lie behind the camera.
std::optional<LinearizedObservation> linearised(const MapObservation& observation, const SE3& T_M_B, const SE3& T_M_K,
                                                const SE3& T_B_C);

/// How the error of a pose becomes that of another that is known against it: T_M_A to T_M_A * T_A_B.
Matrix6d transport(const SE3& T_M_A, const SE3& T_A_B);

/// What the odometry may be off by after dt [s].
Matrix6d drift_covariance(const MapFilterConfig& config, const SE3& T_M_B, double dt);

SE3 corrected(const SE3& T, const Vector6d& error);

}  // namespace edged
