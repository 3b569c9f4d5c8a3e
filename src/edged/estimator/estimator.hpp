// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sliding-window visual-inertial estimator: start-up, window, marginalisation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/core/timing.hpp"
#include "edged/estimator/alignment.hpp"
#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/landmarks.hpp"
#include "edged/estimator/standstill.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

struct EstimatorConfig {
  int recent_states = 3;           ///< newest states, keyframes or not
  int keyframes = 8;               ///< older keyframes
  double max_interval_s = 1.0;     ///< IMU between two keyframes
  int iterations = 4;              ///< of the solver, a packet
  double cauchy_scale = 1.0;       ///< robust loss of visual residuals
  double gyro_bias_sigma = 0.02;   ///< prior of a start in motion
  double rest_gyro_bias_sigma = 0.02;  ///< prior of a start at rest, where the bias has been measured
  double accel_bias_sigma = 0.15;
  double zero_velocity_sigma = 0.01;
  double init_spacing_s = 0.08;    ///< between the views of the start-up buffer
  int init_min_views = 12;         ///< fewer views do not separate scale from accelerometer bias
  int init_max_views = 20;         ///< the buffer's length: slow motion needs the time
  double init_parallax_deg = 2.5;
  double noise_gain = 0.05;        ///< adaptation of each camera's noise to its residuals, a packet
  double noise_inflation = 2.5;    ///< sigma over the spread of the residuals: their errors last from image to image
  double min_noise_scale = 0.3;    ///< bounds of the adapted noise over the configured one
  double max_noise_scale = 4.0;
  LandmarkConfig landmarks;
  StandstillConfig standstill;
  DepthFactorConfig depth_factor;  ///< its options stand beside those of the depth source, not in visit
  void visit(ConfigFields& fields);
};

/// One packet as the estimator sees it.
struct EstimatorInput {
  Timestamp t;
  std::vector<ImuSample> imu;  ///< from the previous input's t to t, both ends included
  std::vector<CameraObservations> observations;
  bool keyframe = false;
  bool events_quiet = false;   ///< the event camera sees nothing move
  std::optional<RegionDepth> depth = std::nullopt;  ///< for Eq. 5, used at keyframes when depth_factor is enabled
};

struct EstimatorResult {
  std::string waiting_for;          ///< while not initialised: what is missing, with numbers
  std::vector<FeatureId> outliers;  ///< tracks that are wrong and should end
  int landmarks = 0;                ///< in the cost
  int landmarks_seen = 0;           ///< of them, seen by the newest state
  bool standstill = false;
  bool plausible = true;            ///< false: the solution has broken down (not finite, or biases and speed beyond reason)
};

class Estimator {
 public:
  Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config);

  /// Inputs in time order.
  EstimatorResult add(const EstimatorInput& input);

  bool initialized() const { return initialized_; }
  /// The newest state; meaningful once initialised.
  NavState newest() const { return window_.newest().nav(); }
  /// Gyro bias known so far (zero at first) [rad/s].
  Eigen::Vector3d gyro_bias() const;

  /// z-depth of a landmark in its own camera at the newest state [m].
  std::optional<double> depth(FeatureId id) const;
  /// s of Eq. 5 as of the last depth factor; nothing without depth_factor.
  std::optional<LogScale> depth_scale() const;

  const Window& window() const { return window_; }

 private:
  std::string try_to_start(const EstimatorInput& input);
  void start_at_rest(const EstimatorInput& input);
  bool start_in_motion();
  void append(const EstimatorInput& input);
  bool take_depth();
  void optimize(EstimatorResult& result, int iterations);
  void adapt_noise();
  void slide();

  ImuNoise noise_;
  Rig rig_;
  EstimatorConfig config_;
  Window window_;
  StandstillDetector standstill_;
  bool initialized_ = false;
  LogScale depth_scale_;
  std::vector<InitFrame> buffer_;        ///< start-up views
  std::vector<ImuSample> pending_imu_;   ///< since the last start-up view
};

}  // namespace edged
