// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/body_motion.hpp"

namespace edged {

Preintegration BodyMotion::predict(const std::vector<ImuSample>& imu, bool started) {
  Preintegration motion(imu, now_.bias_gyro, now_.bias_accel, noise_);
  const Timestamp t = motion.end();
  started_ = started;
  std::erase_if(T_O_B_, [&](const StampedPose& pose) { return pose.t < t - history_ || pose.t >= imu.front().t; });
  if (started) {
    for (const OdomState& state : propagate_all(now_, imu)) T_O_B_.push_back({state.t, state.T_O_B});
    now_ = propagate(now_, motion);
  } else {
    // Neither speed nor tilt are known yet: rotation by the gyro only.
    SE3& pose = now_.T_O_B;
    T_O_B_.push_back({imu.front().t, pose});
    for (std::size_t i = 1; i < imu.size(); ++i) {
      const double dt = to_seconds(imu[i].t - imu[i - 1].t);
      const Eigen::Vector3d rate = 0.5 * (imu[i].gyro_B + imu[i - 1].gyro_B);
      pose = pose * SE3(so3::exp(rate * dt), Eigen::Vector3d::Zero());
      T_O_B_.push_back({imu[i].t, pose});
    }
  }
  now_.t = t;
  omega_B_ = imu.back().gyro_B - now_.bias_gyro;
  return motion;
}

SE3 BodyMotion::moved_on(Duration time) const {
  const double s = to_seconds(time);
  return {now_.T_O_B.rotation() * so3::exp(omega_B_ * s), now_.T_O_B.translation() + now_.v_O * s};
}

SE3 BodyMotion::correct(const OdomState& estimate) {
  SE3 correction = estimate.T_O_B * now_.T_O_B.inverse();
  now_ = estimate;
  for (StampedPose& pose : T_O_B_) pose.T = correction * pose.T;
  return correction;
}

}  // namespace edged
