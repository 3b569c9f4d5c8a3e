// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of the estimator, those of its start included.
#pragma once

#include <cstdint>
#include <string>

#include "edged/config.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// How far a camera's calibration, and the scale and axes of the IMU, may be off: they are estimated online. Zero keeps
/// that part fixed.
struct CalibrationConfig {
  double rotation_sigma_deg = 1.0;
  double time_offset_sigma_ms = 8.0;
  double lever_arm_sigma_mm = 4.0;
  double focal_sigma = 4e-3;              ///< sigma of ln fx and ln fy
  double principal_point_sigma_px = 1.0;  ///< sigma of each coordinate
  double distortion_sigma = 0.01;         ///< first coefficient; the second's moves the rim of the image as far
  double imu_sigma = 5e-3;                ///< each entry of the IMU's intrinsics
  /// Pose of a camera relative to the first one of its kind, and of the first event camera to a frame camera behind
  /// another lens.
  double relative_rotation_sigma_deg = 0.2, baseline_sigma_mm = 1.0;
  /// Nothing is estimated.
  static CalibrationConfig fixed() { return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}; }
  void visit(ConfigFields& fields);
};

/// How errors along a track correlate. KLT tracks a feature from image to image: its drift persists. Of
/// two observations dt apart the errors correlate by correlation * exp(-dt / 2 s): a first-order Gauss-Markov
/// process, plus an independent error of each image. An event frame has a larger independent part, as it is rendered
/// again each time. The larger the assumed drift, the larger the weight of slow motion.
struct TrackNoise {
  double correlation = 0.95;  ///< on frames
  double event_correlation = 0.8;
  double of(Modality modality) const { return modality == Modality::Events ? event_correlation : correlation; }
  void visit(ConfigFields& fields);
};

struct LandmarkConfig {
  double min_depth_m = 0.1;
  double max_depth_m = 60.0;
  double max_residual_sigma = 2.5;  ///< an observation with a larger residual is removed
  double max_misfit = 2.5;          ///< a landmark is removed if its mean residual exceeds the median by this factor
  int max_per_camera = 70;          ///< landmarks in the cost, longest seen first
  void visit(ConfigFields& fields);
};

struct StandstillConfig {
  double window_s = 0.4;    ///< the body must have rested for this long
  double max_gyro = 0.03;   ///< spread of the angular rate's block means [rad/s]
  double max_accel = 0.25;  ///< spread of the acceleration's block means [m/s^2]
  void visit(ConfigFields& fields);
};

/// The residual of Eq. 5.
enum class DepthResidual : std::uint8_t {
  Log,    ///< ln rho_bar - ln s - ln rho_source: dimensionless, for relative errors
  Paper,  ///< rho_bar - s rho_source [1/m]
};

struct DepthFactorConfig {
  bool enabled = false;
  DepthResidual form = DepthResidual::Log;
  double scale_sigma = 0.5;  ///< sigma of ln s before anything is known
  void visit(ConfigFields& fields);
};

/// A barometer, or a range finder above flat ground.
struct HeightConfig {
  bool enabled = true;
  double sigma_m = 0.3;     ///< sigma of a sample that has none of its own
  double bias_walk = 0.05;  ///< [m/sqrt(s)]
  void visit(ConfigFields& fields);
};

/// Wheel odometry, optical flow with range, a DVL.
struct VelocityConfig {
  bool enabled = true;
  double sigma_mps = 0.1;              ///< sigma of a sample that has none of its own
  double scale_sigma = 0.05;           ///< prior of the scale error, measured / true - 1; 0 fixes it at zero
  std::string position_m = "0 0 0";    ///< position of the sensor in B
  std::string rotation_deg = "0 0 0";  ///< roll, pitch, yaw of its axes in B
  /// Pose of the sensor by position_m and rotation_deg; InputError if they are not three numbers.
  SE3 T_B_S() const;
  void visit(ConfigFields& fields);
};

struct EstimatorConfig {
  int recent_states = 3;                 ///< newest states, keyframes or not
  int keyframes = 8;                     ///< older keyframes
  double max_interval_s = 1.0;           ///< IMU between two keyframes
  int iterations = 2;                    ///< solver iterations per packet
  double init_scale_sigma = 0.08;        ///< sigma of ln scale; a wrong start of too large a scale passes more easily
  double provisional_scale_sigma = 0.2;  ///< sigma of ln scale up to which a start is used, as provisional (not Good)
  double noise_inflation = 2.0;          ///< sigma over the spread of what each observation adds to the one before
  double event_noise_inflation = 2.5;    ///< further factor for events beside frames, whose drift is unchanged
  double sigma_inflation =
      1.3;  ///< factor on covariance(): errors common to the features of one image are not modelled
  TrackNoise track_noise;
  CalibrationConfig calibration;
  LandmarkConfig landmarks;
  StandstillConfig standstill;
  DepthFactorConfig depth_factor;
  HeightConfig height;  ///< its options and those of velocity are declared apart, not in visit
  VelocityConfig velocity;
  void visit(ConfigFields& fields);
};

}  // namespace edged
