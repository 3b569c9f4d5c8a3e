// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The pose of the body in O, now and during the packet: IMU propagation from the newest estimate.
#pragma once

#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/imu/noise_estimator.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"

namespace edged {

class ImuPropagator {
 public:
  /// history: how long before a packet poses are kept (the oldest event that a packet's frame can show).
  ImuPropagator(const ImuNoise& noise, Duration history) : noise_(noise), history_(history) {}

  /// Propagates `now` to the end of `imu` and returns the preintegrated motion. started: speed and tilt are estimated;
  /// else attitude by gyro only.
  Preintegration predict(std::vector<ImuSample> imu, bool started);

  /// The noise of the IMU is no less until the next rest.
  void set_noise_at_rest(const ImuNoise& noise) { noise_.set_least(noise); }

  /// Sets `now` to the estimate and transforms the history. Returns T_new_old, from the old odometry frame to the new
  /// one. new_frame: the frames are unrelated, so the two estimates do not measure a rotation.
  SE3 correct(const OdomState& estimate, bool new_frame = false, bool standstill = false);

  const OdomState& now() const { return now_; }
  /// Whether speed and tilt of `now` are estimated.
  bool started() const { return started_; }
  /// The gyro was saturated until the last prediction: the rotation until then is unknown.
  bool gyro_was_saturated() const { return gyro_was_saturated_; }
  /// Duration without samples in the last prediction [s].
  double gap_s() const { return gap_s_; }
  /// Duration without samples until now [s].
  double silent_s() const { return silent_s_; }
  /// T_O_B a few milliseconds after now, at the present rate and velocity.
  SE3 extrapolate(Duration time) const;
  /// Body poses at the IMU samples of the history, oldest first.
  const std::vector<StampedPose>& poses() const { return T_O_B_; }

 private:
  std::vector<ImuSample> bridged(const std::vector<ImuSample>& imu) const;

  ImuNoiseEstimator noise_;
  Duration history_;
  OdomState now_;
  bool started_ = false;
  bool gyro_saturated_ = false, gyro_was_saturated_ = false;  ///< in the last prediction; in the one before alone
  double predicted_s_ = 0.0;                           ///< duration of the last prediction by trusted samples, else 0
  double gap_s_ = 0.0;                                 ///< without samples in the last prediction
  double silent_s_ = 0.0;                              ///< at its end
  Eigen::Vector3d omega_B_ = Eigen::Vector3d::Zero();  ///< [rad/s], now
  std::vector<StampedPose> T_O_B_;
};

}  // namespace edged
