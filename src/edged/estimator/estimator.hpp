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
#include "edged/estimator/solver/sliding.hpp"
#include "edged/estimator/standstill/standstill.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/depth_terms.hpp"
#include "edged/estimator/window/estimator_input.hpp"
#include "edged/estimator/window/flow_velocity.hpp"
#include "edged/estimator/window/window.hpp"
#include "edged/options/estimator.hpp"

namespace edged {

struct EstimatorResult {
  std::string waiting_for;          ///< while not initialised: what is missing, with numbers
  std::vector<FeatureId> outliers;  ///< tracks that should end
  std::string started;              ///< the estimator has started with this input: how, with numbers
  std::vector<Landmark> landmarks;  ///< in the cost
  int landmarks_seen = 0;           ///< landmarks that the newest state observes
  double imu_strain = 0.0;          ///< see imu_strain() [sigma]
  std::vector<MarginalizedKeyframe> marginalized_keyframes;  ///< with this input
  bool standstill = false;
  bool turning = false;                   ///< in place, which is a standstill, too
  std::optional<ImuNoise> noise_at_rest;  ///< measured in this rest
  bool velocity_observed = false;         ///< the velocity was measured recently, by an external sensor
  bool new_frame = false;                 ///< the estimator has started (again) with this input, in a frame of its own
  bool provisional = false;               ///< the scale is not certain enough yet
  bool plausible = true;  ///< false: the solution has diverged (not finite, or implausible biases or speed)
};

class Estimator {
 public:
  /// Time offsets of the rig are residual ones: packets are already stamped on the IMU clock. `intrinsics` (corrections
  /// of each camera, or none) and `biases` (of the IMU) are known from an earlier start.
  Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config,
            std::vector<IntrinsicsCorrection> intrinsics = {}, const std::optional<BiasPrior>& biases = {});

  /// Takes the next input; inputs come in time order.
  EstimatorResult add(const EstimatorInput& input);

  bool initialized() const { return initialized_; }
  /// The initialization is used, but its scale is not known to init_scale_sigma yet, or no later one has confirmed it:
  /// initializations on a dynamic object seldom agree on the velocity.
  bool provisional() const { return scale_sigma_ > config_.init_scale_sigma || !confirmed_; }
  /// The newest state; meaningful once initialised.
  OdomState newest() const { return window_.newest().nav(); }
  /// Gyro bias known so far (zero at first) [rad/s].
  Eigen::Vector3d gyro_bias() const;

  /// Covariance of the newest state (see covariance() of a window), inflated to be consistent. Nothing before
  /// initialization.
  std::optional<Matrix15d> covariance() const;
  /// Covariance of the calibration correction of a camera (CalibrationBlock), inflated in the same way.
  std::optional<CalibrationCovariance> calibration_covariance(std::size_t camera) const;

  /// z-depth of a landmark in a camera at the newest state [m].
  std::optional<double> depth(FeatureId id, const std::string& camera) const;
  /// s of Eq. 5 as of the last depth factor; nothing without depth_factor.
  std::optional<LogScale> depth_scale() const;
  const ExternalCounters& external_counters() const { return external_.counters(); }

  const Window& window() const { return window_; }
  /// All measurements since the start; empty before it, and after keep_no_record().
  StartRecord record() const;
  void keep_no_record() { keeps_record_ = false; }

 private:
  bool start(const EstimatorInput& input, EstimatorResult& result);
  void adopt(StartWindow start, EstimatorResult& result);
  void update_scale(const EstimatorInput& input);
  std::optional<KnownMotion> known_motion(const EstimatorInput& input) const;
  Preintegration since_newest(const EstimatorInput& input) const;
  bool stationary_by_vision() const;
  void append(const EstimatorInput& input, const std::optional<FlowVelocity>& turning);
  std::optional<FlowVelocity> turning_in_place(const EstimatorInput& input) const;
  bool add_depth(const EstimatorInput& input);
  bool solve_window();
  bool raise_imu_noise();
  void optimize(EstimatorResult& result);
  void adapt_noise(double imu_strain);
  std::vector<MarginalizedKeyframe> slide();

  EstimatorConfig config_;
  Window window_;
  StartRecord record_;  ///< of what has left the window
  bool keeps_record_ = true;
  StandstillDetector standstill_;
  ExternalFactors external_;
  Initializer initializer_;
  std::vector<IntrinsicsCorrection> known_intrinsics_;
  bool initialized_ = false;
  double scale_sigma_ = kFree;                        ///< sigma of ln scale
  bool landmarks_in_view_ = false;                    ///< the newest state observes some
  Timestamp supported_at_;                            ///< enough landmarks in view, or at rest
  double depth_m_ = kStandstillTuning.usual_depth_m;  ///< median of the landmarks, the last that there were
  bool confirmed_ = false;  ///< two initializations agree, or none has contradicted one until confirmed_at_
  Timestamp confirmed_at_;
  LogScale depth_scale_;
};

}  // namespace edged
