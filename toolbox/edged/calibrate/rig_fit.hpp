// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Cameras against each other and against the IMU, from their views of a target: one optimization over all of it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "edged/calibrate/lens_fit.hpp"
#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// One corner in one picture, less where the result has it.
struct CornerResidual {
  Timestamp t;
  Eigen::Vector2d pixel, error_px;
};

struct CalibratedCamera {
  FreeLens lens;
  LensParameters lens_sigmas{};
  double sigma_px = 0.0;                    ///< noise of a coordinate of a corner
  SE3 T_B_C;                                ///< without IMU: B is the first camera
  Vector6d pose_sigmas = Vector6d::Zero();  ///< position [m], rotation about the axes of C [rad]
  double time_offset_s = 0.0, time_offset_sigma_s = 0.0;
  std::vector<CornerResidual> residuals;
};

struct RigFit {
  bool has_imu = false;
  std::vector<CalibratedCamera> cameras;
  Eigen::Vector3d bias_gyro = Eigen::Vector3d::Zero(), bias_accel = Eigen::Vector3d::Zero();  ///< mean
  std::size_t states = 0;
  /// Residuals of the inertial terms: root of the mean square of the residuals over their sigmas; 0.2 to 0.6 where the
  /// noise is right, as most of it is taken up by the motion.
  double imu_misfit = 0.0;
};

struct RigFitOptions {
  std::size_t most_states = 600;
  std::function<void(int round)> progress = {};
};

/// With an IMU: lenses, poses and clocks of all cameras, with the motion of the body at the times of the views, tied by
/// preintegration; the lever arm and the clock are unknown at first. Without samples: lenses and poses of the cameras
/// relative to the first, from views within a millisecond of each other. Throws InputError that says what to record.
RigFit fit_rig(const std::vector<TargetCamera>& cameras, const TargetLayout& layout, std::span<const ImuSample> imu,
               const ImuNoise& noise, const RigFitOptions& options = {});

}  // namespace edged
