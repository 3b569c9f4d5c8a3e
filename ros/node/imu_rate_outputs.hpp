// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is published at each IMU sample, as it arrives: the prediction, and the state for an autopilot.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "edged/autopilot/mavlink_output.hpp"
#include "edged/autopilot/vehicle_stream.hpp"
#include "edged/live/arrival_clock.hpp"
#include "edged/pipeline/localization/state_prediction.hpp"
#include "node/messages.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// Predicts in the thread that receives the samples: the thread of the odometry is busy with packets for milliseconds.
/// From any thread.
class ImuRateOutputs {
 public:
  /// gyro_noise: density [rad/s/sqrt(Hz)]. Throws InputError where config.mavlink cannot be opened, config.autopilot is
  /// wrong, or ROS 1 is to have PX4's topic.
  ImuRateOutputs(Transport& transport, const NodeConfig& config, double gyro_noise);

  /// A sample that has just arrived, whose stamp was later by set_by.
  void add(const ImuSample& sample, Duration set_by = {});
  /// Each step, in order. The prediction is that of the base in odom; without T_B_base there is none.
  void note(const Step& step, const SE3& T_map_odom, const std::optional<SE3>& T_B_base);

  /// There is no estimate any more, until the next step.
  void forget();

  /// The body in the map, with the rate that was measured then: that of the newest sample before.
  Estimate estimate_of(const Step& step) const;
  std::optional<Timestamp> newest() const;

 private:
  void keep(const ImuSample& sample);
  double gyro_sigma() const;
  void send_to_autopilot(const NavState& state, const ImuSample& sample);

  const Format format_;
  const double gyro_noise_;
  const std::unique_ptr<Publisher> topic_;
  std::unique_ptr<Publisher> px4_;
  std::unique_ptr<MavlinkOutput> mavlink_;

  mutable std::mutex mutex_;  ///< guards all below: a state and the reset counter of its step belong together
  ArrivalClock clock_;
  VehicleStream stream_;  ///< for PX4
  StatePrediction prediction_;
  std::optional<StateCovariance> covariance_;
  SE3 T_map_odom_;
  std::optional<SE3> T_B_base_;
  std::deque<ImuSample> recent_;
};

}  // namespace edged::node
