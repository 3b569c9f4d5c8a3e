// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sliding-window visual-inertial estimator: from the start on it holds the window, solves it and lets it slide.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/estimator_input.hpp"
#include "edged/estimator/external_factors.hpp"
#include "edged/estimator/initializer.hpp"
#include "edged/estimator/standstill.hpp"
#include "edged/estimator/window.hpp"
#include "edged/options/estimator.hpp"

namespace edged {

struct EstimatorResult {
  std::string waiting_for;          ///< while not initialised: what is missing, with numbers
  std::vector<FeatureId> outliers;  ///< tracks that are wrong and should end
  std::string started;              ///< the estimator has started with this input: how, with numbers
  std::vector<Landmark> landmarks;  ///< in the cost
  int landmarks_seen = 0;           ///< of them, seen by the newest state
  double imu_strain = 0.0;          ///< of the window: see imu_strain() [sigma]
  std::vector<KeyframeRecord>
      marginalized_keyframes;  ///< keyframes that have left the window with this input, in its frame
  bool standstill = false;
  bool velocity_observed = false;  ///< by an external sensor, within the last moment
  bool new_frame = false;          ///< the estimator has started (again) with this input, in a frame of its own
  bool provisional = false;        ///< the start does not know the scale well enough yet
  bool plausible = true;  ///< false: the solution has broken down (not finite, or biases and speed beyond reason)
};

class Estimator {
 public:
  /// The rig's time offsets are those left over: packets are stamped on the clock of the IMU already.
  Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config);

  /// Inputs in time order.
  EstimatorResult add(const EstimatorInput& input);

  bool initialized() const { return initialized_; }
  /// The start is used, but its scale is not known to init_scale_sigma yet, or no later one has found the same: a start
  /// that followed a dynamic object seldom finds the same velocity twice.
  bool provisional() const { return scale_sigma_ > config_.init_scale_sigma || !agreed_; }
  /// The newest state; meaningful once initialised.
  OdomState newest() const { return window_.newest().nav(); }
  /// Gyro bias known so far (zero at first) [rad/s].
  Eigen::Vector3d gyro_bias() const;

  /// Of the newest state: see covariance() of a window; inflated, so that errors keep within it. Nothing before the
  /// start.
  std::optional<Matrix15d> covariance() const;
  /// Of what a camera's calibration is off by (CalibrationBlock); inflated in the same way.
  std::optional<Eigen::Matrix4d> calibration_covariance(std::size_t camera) const;

  /// z-depth of a landmark in a camera at the newest state [m].
  std::optional<double> depth(FeatureId id, const std::string& camera) const;
  /// s of Eq. 5 as of the last depth factor; nothing without depth_factor.
  std::optional<LogScale> depth_scale() const;

  const Window& window() const { return window_; }

 private:
  bool start(const EstimatorInput& input, EstimatorResult& result);
  void update_scale(const EstimatorInput& input);
  Preintegration since_newest(const EstimatorInput& input) const;
  bool rests_by_picture() const;
  void append(const EstimatorInput& input);
  bool take_depth(const EstimatorInput& input);
  void optimize(EstimatorResult& result, int iterations);
  void adapt_noise(double imu_strain);
  std::vector<KeyframeRecord> slide();

  ImuNoise noise_;
  EstimatorConfig config_;
  Window window_;
  StandstillDetector standstill_;
  ExternalFactors external_;
  Initializer initializer_;
  bool initialized_ = false;
  double scale_sigma_ = kFree;   ///< of ln scale
  bool sees_landmarks_ = false;  ///< the newest state
  bool agreed_ = false;          ///< two starts have, or nothing has contradicted one until agreed_by_itself_
  Timestamp agreed_by_itself_;
  LogScale depth_scale_;
};

}  // namespace edged
