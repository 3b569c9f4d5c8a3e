// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sliding-window visual-inertial estimator: after initialization it maintains, solves and slides the window.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/external/external_factors.hpp"
#include "edged/estimator/initialization/initializer.hpp"
#include "edged/estimator/standstill/standstill.hpp"
#include "edged/estimator/window/depth_terms.hpp"
#include "edged/estimator/window/estimator_input.hpp"
#include "edged/estimator/window/window.hpp"
#include "edged/options/estimator.hpp"

namespace edged {

/// Of sigmas, events alone, times that of the options: dynamic objects mislead them more easily.
inline constexpr double kEventsAloneInflation = 1.4;

struct EstimatorResult {
  std::string waiting_for;          ///< while not initialised: what is missing, with numbers
  std::vector<FeatureId> outliers;  ///< outlier tracks, which should end
  std::string started;              ///< the estimator has started with this input: how, with numbers
  std::vector<Landmark> landmarks;  ///< in the cost
  int landmarks_seen = 0;           ///< of them, observed by the newest state
  double imu_strain = 0.0;          ///< of the window: see imu_strain() [sigma]
  std::vector<KeyframeRecord>
      marginalized_keyframes;  ///< keyframes that were marginalized with this input, in its frame
  bool standstill = false;
  bool velocity_observed = false;  ///< the velocity was measured recently, by an external sensor
  bool new_frame = false;          ///< the estimator has started (again) with this input, in a frame of its own
  bool provisional = false;        ///< the scale is not certain enough yet
  bool plausible = true;           ///< false: the solution has diverged (not finite, or implausible biases or speed)
};

class Estimator {
 public:
  /// Time offsets of the rig are residual ones: packets are already stamped on the IMU clock.
  /// Known from an earlier start: intrinsics, corrections of each camera, or none; biases, those of the IMU.
  Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config,
            std::vector<IntrinsicsCorrection> intrinsics = {}, const std::optional<BiasPrior>& biases = {});

  /// Inputs in time order.
  EstimatorResult add(const EstimatorInput& input);

  bool initialized() const { return initialized_; }
  /// The initialization is used, but its scale is not known to init_scale_sigma yet, or no later one has confirmed it:
  /// initializations on a dynamic object seldom agree on the velocity.
  bool provisional() const { return scale_sigma_ > config_.init_scale_sigma || !agreed_; }
  /// The newest state; meaningful once initialised.
  OdomState newest() const { return window_.newest().nav(); }
  /// Gyro bias known so far (zero at first) [rad/s].
  Eigen::Vector3d gyro_bias() const;

  /// Of the newest state: see covariance() of a window; inflated to be consistent. Nothing before initialization.
  std::optional<Matrix15d> covariance() const;
  /// Of the calibration correction of a camera (CalibrationBlock); inflated in the same way.
  std::optional<CalibrationCovariance> calibration_covariance(std::size_t camera) const;

  /// z-depth of a landmark in a camera at the newest state [m].
  std::optional<double> depth(FeatureId id, const std::string& camera) const;
  /// s of Eq. 5 as of the last depth factor; nothing without depth_factor.
  std::optional<LogScale> depth_scale() const;
  const ExternalCounters& external_counters() const { return external_.counters(); }

  const Window& window() const { return window_; }

 private:
  bool start(const EstimatorInput& input, EstimatorResult& result);
  void update_scale(const EstimatorInput& input);
  Preintegration since_newest(const EstimatorInput& input) const;
  bool rests_by_image() const;
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
  std::vector<IntrinsicsCorrection> known_intrinsics_;
  bool initialized_ = false;
  double scale_sigma_ = kFree;   ///< of ln scale
  bool sees_landmarks_ = false;  ///< the newest state
  bool agreed_ = false;          ///< two initializations agree, or nothing has contradicted one until agreed_by_itself_
  Timestamp agreed_by_itself_;
  LogScale depth_scale_;
};

}  // namespace edged
