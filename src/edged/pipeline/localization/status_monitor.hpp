// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Determines the tracking status.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "edged/estimator/estimator.hpp"
#include "edged/options.hpp"
#include "edged/step.hpp"
#include "edged/time.hpp"

namespace edged {

/// Whether the estimate itself says that it may be wrong.
struct Uncertainty {
  double bias_change = 0.0;                ///< of the IMU, see BiasHistory [sigma]
  std::optional<double> scale_sigma = {};  ///< relative, see ScaleUncertainty
  double velocity_sigma = 0.0;             ///< of the worst axis, beyond what the speed allows [m/s]
  double place_sigma = 0.0;                ///< of the position in the map, by a loss or a gap [m]
};

/// Determines the tracking status from the estimator's results, packet by packet. Each loss by IMU strain raises its
/// limit by half: strain that recurs after a new start is not caused by the scene, but by an IMU noisier than its
/// calibration.
class StatusMonitor {
 public:
  explicit StatusMonitor(const StatusConfig& config) : config_(config) {}

  /// The status of a packet at t; while the estimator has not started, Initializing before its first start and Lost
  /// after.
  TrackingStatus update(const EstimatorResult& result, const Uncertainty& uncertainty, bool started, Timestamp t);
  /// With map.localize_only there is a pose only while the body is localized in the map. of_odometry: by update;
  /// unlocalized: why the body is not localized; empty if it is.
  TrackingStatus update_in_map(TrackingStatus of_odometry, const std::string& unlocalized);
  /// The estimate was ended by another part.
  void set_lost(std::string reason);
  /// Why the last status was Lost or Degraded, with numbers.
  const std::string& reason() const { return reason_; }
  /// The last loss was by a contradiction of cameras and IMU: the last poses before are wrong.
  bool contradicted() const { return contradicted_; }
  /// Time without enough landmarks or rest until the last packet [s].
  double since_visual_update_s() const { return since_visual_update_s_; }
  /// The last loss was only a loss of vision: the estimate was valid until then.
  bool vision_lost() const { return vision_lost_; }

 private:
  std::string contradiction(double imu_strain, double bias_change);
  std::string unknown_motion(double velocity_sigma, Timestamp t);
  std::string doubt(const EstimatorResult& result, const Uncertainty& uncertainty) const;

  StatusConfig config_;
  bool ever_started_ = false, ever_localized_ = false;
  double strain_limit_factor_ = 1.0;         ///< on the limits of strain
  std::optional<Timestamp> last_supported_;  ///< by landmarks or standstill, since the start
  std::optional<Timestamp> last_velocity_;   ///< by a sensor, which keeps an estimate without landmarks alive
  std::optional<Timestamp> velocity_known_;  ///< was it last, by the covariance
  double since_visual_update_s_ = 0.0;
  std::string reason_;
  bool vision_lost_ = false;
  bool contradicted_ = false;
};

}  // namespace edged
