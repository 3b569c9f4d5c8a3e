// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/imu_propagator.hpp"

#include <algorithm>

namespace edged {

/// If all samples are missing, the body keeps its angular velocity and has no acceleration. Samples interpolated
/// between the ends of a long gap would be less accurate, and wrong about the direction of gravity.
void ImuPropagator::bridge(std::vector<ImuSample>& imu) const {
  for (ImuSample& sample : imu) {
    const Eigen::Quaterniond R_O_B = now_.T_O_B.rotation() * so3::exp(omega_B_ * to_seconds(sample.t - imu.front().t));
    sample.gyro_B = now_.bias_gyro + omega_B_;
    sample.accel_B = now_.bias_accel - R_O_B.conjugate() * kGravity_W;
  }
}

Preintegration ImuPropagator::predict(std::vector<ImuSample> imu, bool started) {
  const ImuNoise& noise = noise_.add(imu);
  const bool bridged = started && std::ranges::all_of(imu, &ImuSample::interpolated);
  if (bridged) bridge(imu);
  Preintegration motion(imu, now_.bias_gyro, now_.bias_accel, noise);
  const Timestamp t = motion.end();
  gyro_was_saturated_ = gyro_saturated_ && !motion.gyro_clipped();
  gyro_saturated_ = motion.gyro_clipped();
  started_ = started;
  predicted_s_ = started && motion.gyro_trusted() ? motion.dt() : 0.0;
  bridged_s_ = bridged ? motion.dt() : 0.0;
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

SE3 ImuPropagator::extrapolate(Duration time) const {
  const double s = to_seconds(time);
  return {now_.T_O_B.rotation() * so3::exp(omega_B_ * s), now_.T_O_B.translation() + now_.v_O * s};
}

SE3 ImuPropagator::correct(const OdomState& estimate, bool new_frame, bool standstill) {
  SE3 correction = estimate.T_O_B * now_.T_O_B.inverse();
  if (bridged_s_ > 0.0 && !new_frame)  // only the cameras measure the rate
    omega_B_ += so3::log(now_.T_O_B.rotation().conjugate() * estimate.T_O_B.rotation()) / bridged_s_;
  if (!new_frame && !standstill && predicted_s_ > 0.0)
    noise_.add_correction(now_.t, estimate.v_O - now_.v_O, predicted_s_);
  now_ = estimate;
  for (StampedPose& pose : T_O_B_) pose.T = correction * pose.T;
  return correction;
}

}  // namespace edged
