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
#include "edged/pipeline/localization/online_calibration.hpp"
#include "edged/pipeline/localization/place_uncertainty.hpp"
#include "edged/pipeline/localization/scale_uncertainty.hpp"
#include "edged/pipeline/localization/status_monitor.hpp"
#include "edged/pipeline/mapping/mapper.hpp"
#include "edged/pipeline/tuning.hpp"
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
  /// keeps_measurements: FeedConfig's.
  Localization(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config, StageTimings& timings,
               bool keeps_measurements = true);

  /// Propagates the body to the last of the samples, which begin at its time, and returns that motion.
  Preintegration predict(const std::vector<ImuSample>& imu);
  /// The body in O: predicted; after process estimated.
  const ImuPropagator& body() const { return body_; }
  /// motion: as returned by predict; seen: observations at its end; external: samples within it, in time order.
  LocalizationOutput process(Preintegration motion, const VisionOutput& seen,
                             std::vector<ExternalSample> external = {});
  /// A clock was set back and a new epoch begins: the estimate ends. The next start continues from the last pose, as
  /// after a loss.
  void begin_epoch();

  // These are as in Odometry.
  void load_map(std::string_view bytes);
  std::optional<std::string> save_map() const;
  bool awaiting_relocalization() const { return mapper_.awaiting_relocalization(); }
  FinalTrajectory final_trajectory(const OptimizationProgress& progress = {}) const {
    return mapper_.final_trajectory(session_.estimator.record(), progress);
  }
  Rig rig() const { return calibration_.total(); }
  std::optional<CalibrationCovariance> calibration_covariance(const std::string& camera) const;
  ExternalCounters external_counters() const;

 private:
  /// All that ends with an estimate: from one start of the estimator, and the wait for it, to the next.
  struct Session {
    Estimator estimator;
    std::optional<BiasPrior> bias_prior;  ///< that the estimator starts with, by earlier estimates
    ExternalCounters earlier_counters;    ///< sum over earlier sessions
    Timestamp dead_reckoning_until;       ///< before the start
    BiasHistory biases;
    ScaleUncertainty scale{to_seconds(kPipelineTuning.judged)};  ///< of the present start
    Uncertainty uncertainty = {};                                ///< as of the last covariance
    std::optional<StateCovariance> covariance = {};
    Timestamp covariance_at = {};
    std::optional<OdomUncertainty> known = {};  ///< of the last covariance, too
    Eigen::Vector3d started_at_O = Eigen::Vector3d::Zero();
  };
  Session new_session(const std::optional<BiasPrior>& prior, const ExternalCounters& earlier, Timestamp until) const;
  void end_session(const std::optional<BiasPrior>& prior, Timestamp dead_reckoning_until);
  std::optional<BiasPrior> prior_after_loss() const;
  EstimatorResult estimate(const EstimatorInput& input, VisionCorrection& correction);
  LandmarkDepths landmark_depths() const;
  bool update_map(Timestamp t, const VisionOutput& seen, const EstimatorResult& result);
  TrackingStatus status_in_map(TrackingStatus of_odometry);
  std::string missing_localization() const;
  std::vector<PosedImage> mapping_images(const VisionOutput& seen, const std::vector<FeatureId>& outliers);
  void update_covariance(Timestamp t);
  OdomUncertainty uncertainty(const Matrix15d& P) const;
  PlaceUncertainty::DeadReckoning dead_reckoning() const;
  PlaceUncertainty::DeadReckoning in_place() const;
  PlaceUncertainty::DeadReckoning contradicted() const;
  StateCovariance covariance_in_map(const Matrix15d& P) const;
  void map_window();
  bool seen_by_frames(const VisionOutput& seen) const;
  LocalizationOutput end_at_gap(const Preintegration& motion, const VisionOutput& seen);
  Step describe(Timestamp t, TrackingStatus status, EstimatorResult result) const;

  OdometryConfig config_;
  bool keeps_measurements_;
  ImuNoise noise_;
  StageTimings* timings_;
  OnlineCalibration calibration_;
  Session session_;
  Mapper mapper_;
  StatusMonitor status_;
  PlaceUncertainty place_;
  ImuPropagator body_;
  std::optional<AttitudeFilter> attitude_;  ///< until the first start
};

}  // namespace edged
