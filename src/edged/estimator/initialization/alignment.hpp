// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Visual-inertial alignment: initializes the estimator in motion, from feature tracks and IMU alone.
//
// 1. The gyro bias is the one whose rotations make the feature rays of each pair of views coplanar with some baseline
//    (the coplanarity of Kneip and Lynen, "Direct optimization of frame-to-frame rotation", ICCV 2013, here with the
//    rotations coupled by the gyro).
// 2. With rotations known, landmark positions, the first velocity and gravity are linear in the rays (Martinelli,
//    "Closed-form solution of visual-inertial structure from motion", IJCV 2014); landmarks are eliminated one by one,
//    and the magnitude of gravity is a constraint. The scale is metric from the start.
// 3. Feature noise makes that linear solution too small: a few Gauss-Newton steps on the reprojection errors follow,
//    with the accelerometer bias. Their normal equations give the uncertainty of the scale. Samples of a velocity
//    sensor are linear in the same unknowns (steps 2 and 3): they determine the scale of a motion without acceleration.
// 4. A dynamic object fits as well as the static scene: the motion relative to it is consistent, too, and the IMU does
//    not measure velocity. If one motion does not fit nearly all features, patches of the view make hypotheses, and
//    the one that explains most of the view is chosen.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/initialization/initialization_solver.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/rig.hpp"

namespace edged {

struct Alignment {
  std::vector<OdomState> states;  ///< one a frame; O z-up, origin and yaw at the first body pose
  double gravity_error = 0.0;     ///< |g| estimated without the constraint, relative to 9.81: a check of the solution
  double scale_sigma = 0.0;       ///< standard deviation of the longest baseline over its length, from the features
  double baseline_sigma = 0.0;    ///< standard deviation of ln scale by the baselines between cameras
  std::set<FeatureId> outliers;   ///< features of dynamic objects
  /// Share of the observations that it explains which a running estimate explains too, 0 to 1: small if that one
  /// follows a dynamic object.
  double inlier_share = 1.0;
};

/// Gyro bias [rad/s] that best explains the image rotation; nothing with too few common features.
std::optional<Eigen::Vector3d> align_gyro_bias(const std::vector<InitFrame>& frames, const Rig& rig,
                                               const ImuNoise& noise);

/// States of all frames. running: an estimate at the time of the last frame, to be checked, or null. Nothing when the
/// linear system is not determined (too few tracks, no translation).
std::optional<Alignment> align(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise,
                               const StartPriors& priors, const OdomState* running = nullptr);

}  // namespace edged
