// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of the estimator, those of its start included.
#pragma once

#include "edged/core/config.hpp"
#include "edged/estimator/landmarks.hpp"
#include "edged/estimator/region_depth.hpp"
#include "edged/estimator/standstill.hpp"

namespace edged {

struct EstimatorConfig {
  int recent_states = 3;                ///< newest states, keyframes or not
  int keyframes = 8;                    ///< older keyframes
  double max_interval_s = 1.0;          ///< IMU between two keyframes
  int iterations = 2;                   ///< of the solver, a packet
  double cauchy_scale = 1.0;            ///< robust loss of visual residuals
  double gyro_bias_sigma = 0.02;        ///< prior of a start in motion
  double rest_gyro_bias_sigma = 0.005;  ///< prior of a start at rest, where the bias has been measured
  double accel_bias_sigma = 0.15;
  double zero_velocity_sigma = 0.01;
  double init_spacing_s = 0.08;  ///< between the views of the start-up buffer, at most
  double init_turn_deg = 5.0;    ///< a turn by this makes the next view sooner
  int init_min_views = 8;
  int init_max_views = 24;
  double init_max_span_s = 7.0;          ///< tracks last, and biases stay, for so long
  double init_scale_sigma = 0.08;        ///< of ln scale; a wrong start of too large a scale passes more easily
  double provisional_scale_sigma = 0.2;  ///< a start that knows it to this is used, but not Good
  double noise_gain = 0.05;              ///< adaptation of each camera's noise to its residuals, a packet
  double noise_inflation = 2.0;          ///< sigma over the spread of what each sight adds to the one before
  double event_noise_inflation = 2.5;    ///< times as much for events beside frames: their drift goes on as it was
  double min_noise_scale = 0.05;         ///< bounds of the adapted noise over the configured one
  double max_noise_scale = 4.0;
  double max_imu_strain = 0.5;  ///< beyond it (imu_strain()) the cameras are believed less
  double sigma_inflation =
      2.0;  ///< of what covariance() gives: what corners of one image have in common is not modelled
  TrackNoise track_noise;
  CalibrationConfig calibration;
  LandmarkConfig landmarks;
  StandstillConfig standstill;
  DepthFactorConfig depth_factor;  ///< its options stand beside those of the depth source, not in visit
  void visit(ConfigFields& fields);
};

}  // namespace edged
