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
  double focal_sigma = 4e-3;              ///< of ln fx and ln fy
  double principal_point_sigma_px = 1.0;  ///< of each coordinate
  double distortion_sigma =
      0.01;                 ///< of the first coefficient; the second's has the same effect at the rim of the image
  double imu_sigma = 5e-3;  ///< of each entry of the IMU's intrinsics
  /// Of a camera and the first one of its kind, and of the first event camera and a frame camera behind another lens.
  double relative_rotation_sigma_deg = 0.2;
  double baseline_sigma_mm = 1.0;  ///< between them
  /// All as given.
  static CalibrationConfig fixed() { return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}; }
  void visit(ConfigFields& fields);
};

/// How errors along a track correlate. KLT tracks a feature from image to image: its drift persists. Of
/// two observations dt apart the errors correlate by correlation * exp(-dt / time_s): a first-order Gauss-Markov
/// process, plus an independent error of each image. An event frame has a larger independent part, as it is rendered
/// anew each time. The larger the assumed drift, the larger the weight of slow motion.
struct TrackNoise {
  double correlation = 0.95;  ///< on frames
  double event_correlation = 0.8;
  double time_s = 2.0;
  double of(Modality modality) const { return modality == Modality::Events ? event_correlation : correlation; }
  void visit(ConfigFields& fields);
};

struct LandmarkConfig {
  double min_parallax_deg = 0.6;  ///< a feature becomes a landmark once its rays differ by this
  double min_depth_m = 0.1;
  double max_depth_m = 60.0;
  double max_residual_sigma = 2.5;    ///< an observation with a larger residual is removed
  double max_innovation_sigma = 6.0;  ///< so is one farther from its prediction by the IMU
  double max_misfit = 2.5;  ///< so is a landmark whose mean residual is larger than the others' by this factor
  int max_per_camera = 70;  ///< landmarks in the cost, longest seen first
  void visit(ConfigFields& fields);
};

struct StandstillConfig {
  double window_s = 0.4;                         ///< the body must have rested for this long
  double max_gyro = 0.03;                        ///< spread of the angular rate's block means [rad/s]
  double max_accel = 0.25;                       ///< spread of the acceleration's block means [m/s^2]
  static constexpr double max_gyro_mean = 0.15;  ///< a mean rate above this is motion, not bias [rad/s]
  double max_image_motion = 4e-3;  ///< median travel of the features over the window, on the unit plane [rad]
  static constexpr double quiet_window_s = 0.7;  ///< duration of rest after which the IMU alone suffices
  double quiet_gyro = 0.008;                     ///< spread then, near a sensor's own noise [rad/s]
  double quiet_accel = 0.1;                      ///< [m/s^2]
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
  double scale_sigma = 0.5;                   ///< of ln s before anything is known
  static constexpr double scale_walk = 0.02;  ///< [1/sqrt(s)]
  static constexpr double noise_share =
      0.5;  ///< factor on sigma_ln of the source: errors that change with time, which s does not model
  static constexpr double min_interval_s =
      0.5;                                     ///< between two factors: the errors of the source are correlated in time
  static constexpr int min_landmarks = 8;      ///< in the region
  static constexpr double gate = 3.0;          ///< [sigma]
  static constexpr double cauchy_scale = 1.0;  ///< [sigma]

  void visit(ConfigFields& fields);
};

/// A barometer, or a range finder above flat ground.
struct HeightConfig {
  bool enabled = true;
  double sigma_m = 0.3;     ///< of a sample that has none of its own
  double bias_walk = 0.05;  ///< [m/sqrt(s)]
  void visit(ConfigFields& fields);
};

/// Wheel odometry, optical flow with range, a DVL.
struct VelocityConfig {
  bool enabled = true;
  double sigma_mps = 0.1;                     ///< of a sample that has none of its own
  double scale_sigma = 0.05;                  ///< prior of the scale error, measured / true - 1; 0 fixes it at zero
  static constexpr double scale_walk = 2e-3;  ///< [1/sqrt(s)]
  std::string position_m = "0 0 0";           ///< of the sensor in B
  std::string rotation_deg = "0 0 0";         ///< roll, pitch, yaw of its axes in B
  /// The last two; InputError if they are not three numbers.
  SE3 T_B_S() const;
  void visit(ConfigFields& fields);
};

struct EstimatorConfig {
  int recent_states = 3;                                 ///< newest states, keyframes or not
  int keyframes = 8;                                     ///< older keyframes
  double max_interval_s = 1.0;                           ///< IMU between two keyframes
  int iterations = 2;                                    ///< of the solver, a packet
  double cauchy_scale = 1.0;                             ///< robust loss of visual residuals
  double gyro_bias_sigma = 0.02;                         ///< prior of a start in motion
  static constexpr double rest_gyro_bias_sigma = 0.005;  ///< prior of a start at rest, where the bias has been measured
  double accel_bias_sigma = 0.15;
  static constexpr double zero_velocity_sigma = 0.01;
  static constexpr double init_spacing_s = 0.08;  ///< between the views of the start-up buffer, at most
  static constexpr double init_turn_deg = 5.0;    ///< a rotation by this adds the next view earlier
  static constexpr int init_min_views = 8;
  int init_max_views = 24;
  double init_max_span_s = 7.0;    ///< tracks last, and biases stay, for so long
  double init_scale_sigma = 0.08;  ///< of ln scale; a wrong start of too large a scale passes more easily
  double provisional_scale_sigma =
      0.2;                       ///< sigma of ln scale up to which an initialization is used, as provisional (not Good)
  double noise_gain = 0.05;      ///< adaptation of each camera's noise to its residuals, a packet
  double noise_inflation = 2.0;  ///< sigma over the spread of what each observation adds to the one before
  double event_noise_inflation = 2.5;  ///< further factor for events beside frames, whose drift is unchanged
  static constexpr double min_noise_scale = 0.05;  ///< bounds of the adapted noise over the configured one
  static constexpr double max_noise_scale = 4.0;
  double max_imu_strain = 0.5;  ///< above this imu_strain() the observations have less weight
  double sigma_inflation =
      1.3;  ///< factor on covariance(): errors common to the features of one image are not modelled
  TrackNoise track_noise;
  CalibrationConfig calibration;
  LandmarkConfig landmarks;
  StandstillConfig standstill;
  DepthFactorConfig depth_factor;
  HeightConfig height;  ///< the options of these two are declared apart, not in visit
  VelocityConfig velocity;
  void visit(ConfigFields& fields);
};

}  // namespace edged
