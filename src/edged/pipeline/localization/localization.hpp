// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Localization: from observations and IMU to states, in the estimator's window and in the map. It neither renders nor
// tracks.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/estimator/estimator.hpp"
#include "edged/estimator/standstill/attitude_filter.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/imu_noise.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/localization/bias_history.hpp"
#include "edged/pipeline/localization/imu_propagator.hpp"
#include "edged/pipeline/localization/status_monitor.hpp"
#include "edged/pipeline/mapping/mapper.hpp"
#include "edged/pipeline/vision/vision.hpp"
#include "edged/rig.hpp"
#include "edged/step.hpp"
#include "edged/timing.hpp"

namespace edged {

struct LocalizationOutput {
  Step step;  ///< without its cameras
  VisionCorrection correction;
};

/// A cycle is predict, then process. Deterministic.
class Localization {
 public:
  /// cameras: those of the run, event cameras first; config: validated.
  Localization(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config, StageTimings& timings);

  /// Propagates the body to the last of the samples, which begin at its time, and returns that motion.
  Preintegration predict(const std::vector<ImuSample>& imu);
  /// In O: predicted; after process estimated.
  const BodyMotion& body() const { return body_; }
  /// motion: as returned by predict; seen: observations at its end; external: samples within it, in time order.
  LocalizationOutput process(Preintegration motion, const VisionOutput& seen,
                             std::vector<ExternalSample> external = {});
  /// A clock was set back and a new time begins: the estimate ends. The next start continues from the last pose, as
  /// after a loss.
  void begin_time();

  /// As in Odometry.
  void load_map(std::string_view bytes);
  std::optional<std::string> save_map() const;
  bool awaiting_relocalization() const { return mapper_.awaiting_relocalization(); }
  FinalTrajectory final_trajectory() const;
  Rig rig() const;
  std::optional<CalibrationCovariance> calibration_covariance(const std::string& camera) const;
  ExternalCounters external_counters() const;

 private:
  Estimator fresh_estimator() const { return {rig_, noise_, config_.estimator, intrinsics_, known_biases_}; }
  void begin_estimate();
  void learn_biases();
  EstimatorResult estimate(const EstimatorInput& input, VisionCorrection& correction);
  LandmarkDepths landmark_depths() const;
  bool follow_map(Timestamp t, const VisionOutput& seen, const EstimatorResult& result);
  TrackingStatus status_in_map(TrackingStatus of_odometry);
  std::string missing_localization() const;
  std::vector<PosedImage> mapping_images(const VisionOutput& seen, const std::vector<FeatureId>& outliers);
  void take_calibrations();
  const CameraModel& image_model(std::size_t camera, const CameraModel& given);
  void update_covariance(Timestamp t);
  Step describe(Timestamp t, TrackingStatus status, EstimatorResult result) const;

  OdometryConfig config_;
  ImuNoise noise_;
  Rig given_rig_;  ///< the cameras of the run
  Rig rig_;        ///< the same with online calibration of poses and clocks; with residual time offsets
  std::vector<IntrinsicsCorrection> intrinsics_;  ///< of rig_'s cameras, estimated
  /// A model with corrections, made anew once these have moved.
  struct KnownModel {
    IntrinsicsCorrection intrinsics = IntrinsicsCorrection::Zero();
    std::optional<CameraModel> model;
    bool holds(const IntrinsicsCorrection& now, double most_off) const {
      return model && (now - intrinsics).cwiseAbs().maxCoeff() <= most_off;
    }
  };
  std::vector<KnownModel> image_models_;  ///< of the cameras' images: for the map, whose points have them
  std::vector<KnownModel> lens_models_;   ///< of the cameras: for rig(), which the ROS node calls at each step
  StageTimings* timings_;
  std::optional<BiasPrior> known_biases_;  ///< by the estimates before
  Estimator estimator_;
  ExternalCounters counters_before_;  ///< by the estimators before
  Mapper mapper_;
  FinalTrajectory before_;  ///< of the times before the newest clock reset
  StatusJudge judge_;
  BiasHistory biases_;        ///< of this estimate
  double bias_change_ = 0.0;  ///< as of the last covariance [sigma]
  BodyMotion body_;
  std::optional<AttitudeFilter> attitude_;  ///< until the first start
  bool gyro_clipped_ = false;               ///< in this packet
  bool turned_unseen_ = false;              ///< it was until this packet
  bool localized_ = false;                  ///< with map.localize_only: a pose in the map has been published
  std::optional<StateCovariance> covariance_;
  Timestamp covariance_at_;
  Timestamp dead_reckoning_until_ = Timestamp::min();  ///< without an estimate: end of dead reckoning
};

/// The packetizer applies the time offsets; the estimator handles residual ones.
Rig without_offsets(Rig rig);

}  // namespace edged
