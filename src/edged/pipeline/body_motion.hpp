// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the body is in O, now and while the events of the packet came: IMU propagation from the newest estimate.
#pragma once

#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"

namespace edged {

class BodyMotion {
 public:
  /// history: how long before a packet poses are kept (the oldest event that a packet's frame can show).
  BodyMotion(const ImuNoise& noise, Duration history) : noise_(noise), history_(history) {}

  /// Moves `now` to the end of `imu` and gives that motion, integrated. started: the estimator knows speed and tilt;
  /// else attitude by gyro only.
  Preintegration predict(std::vector<ImuSample> imu, bool started);

  /// `now` as estimated: the history moves along. Returns from the old odometry frame to the new one, T_new_old.
  /// new_frame: that is another one, so that the two say nothing of how the body turned.
  SE3 correct(const OdomState& estimate, bool new_frame = false);

  const OdomState& now() const { return now_; }
  /// Whether speed and tilt of `now` mean anything.
  bool started() const { return started_; }
  /// T_O_B a few milliseconds after now, turning and moving on as it does now.
  SE3 moved_on(Duration time) const;
  /// Body poses at the IMU samples of the history, oldest first.
  const std::vector<StampedPose>& poses() const { return T_O_B_; }

 private:
  void bridge(std::vector<ImuSample>& imu) const;

  ImuNoise noise_;
  Duration history_;
  OdomState now_;
  bool started_ = false;
  double bridged_s_ = 0.0;                             ///< length of the last prediction where it is across a gap
  Eigen::Vector3d omega_B_ = Eigen::Vector3d::Zero();  ///< [rad/s], now
  std::vector<StampedPose> T_O_B_;
};

}  // namespace edged
