// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How far the present pose can be relied on.
#pragma once

#include <optional>
#include <string>

#include "edged/core/config.hpp"
#include "edged/core/time.hpp"
#include "edged/estimator/estimator.hpp"

namespace edged {

enum class TrackingStatus { Initializing, Good, Degraded, Lost };
std::string to_string(TrackingStatus status);
/// Whether there is a pose to go by: Good or Degraded.
bool is_tracking(TrackingStatus status);

struct StatusConfig {
  double degraded_after_s = 0.7;  ///< without enough landmarks or rest
  double lost_after_s = 2.5;
  int min_landmarks = 8;          ///< seen by the newest state, for a Good pose
  double degraded_strain = 0.75;  ///< EstimatorResult::imu_strain [sigma]: usual is 0.05 to 0.4
  double lost_strain = 0.85;      ///< the first time; see StatusJudge
  void visit(ConfigFields& fields);
};

/// Judges what the estimator says, packet by packet. Each loss by strain makes it bear half as much again: what comes
/// back after a new start is not the world's doing, but an IMU noisier than its calibration says.
class StatusJudge {
 public:
  explicit StatusJudge(const StatusConfig& config) : config_(config) {}

  /// Of a packet at t; while the estimator has not started, Initializing before its first start and Lost after.
  TrackingStatus judge(const EstimatorResult& result, bool started, Timestamp t);
  /// Why the last one was Lost, with numbers.
  const std::string& reason() const { return reason_; }

 private:
  StatusConfig config_;
  bool ever_started_ = false;
  double patience_ = 1.0;                    ///< multiplies the limits of strain
  std::optional<Timestamp> last_supported_;  ///< by landmarks or rest, since the start
  std::string reason_;
};

}  // namespace edged
