// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/imu_propagator.hpp"

#include <algorithm>

namespace edged {
namespace {

constexpr Duration kNext = std::chrono::microseconds(1);  // a step beside a sample

}  // namespace

/// In a gap the rate changes linearly to the next one that is measured, and the body has no acceleration. Samples
/// interpolated between the ends of a long gap would be wrong about the direction of gravity.
std::vector<ImuSample> ImuPropagator::bridged(const std::vector<ImuSample>& imu) const {
  std::vector<ImuSample> samples;
  Eigen::Quaterniond R_O_B = now_.T_O_B.rotation();
  Eigen::Vector3d rate = omega_B_;
  const auto turn = [&](Timestamp t, const Eigen::Vector3d& next) {
    const double dt = samples.empty() ? 0.0 : to_seconds(t - samples.back().t);
    R_O_B = R_O_B * so3::exp(0.5 * dt * (rate + next));
    rate = next;
  };
  const auto add = [&](Timestamp t, const Eigen::Vector3d& next) {
    turn(t, next);
    samples.push_back({t, now_.bias_gyro + rate, now_.bias_accel - R_O_B.conjugate() * kGravity_W, true});
  };
  for (const ImuSample& b : imu) {
    if (!samples.empty() && in_gap(samples.back(), b)) {
      const ImuSample a = samples.back();
      const Eigen::Vector3d from = a.gyro_B - now_.bias_gyro;
      const Eigen::Vector3d to = b.interpolated ? from : Eigen::Vector3d(b.gyro_B - now_.bias_gyro);
      const Timestamp begin = a.interpolated ? a.t : a.t + kNext, end = b.interpolated ? b.t : b.t - kNext;
      const auto steps = std::clamp<Duration::rep>((end - begin) / kMaxSampleInterval, 1, 100);
      for (Duration::rep k = a.interpolated ? 1 : 0; k <= steps; ++k)
        add(begin + (end - begin) * k / steps,
            from + (to - from) * static_cast<double>(k) / static_cast<double>(steps));
    } else if (b.interpolated) {
      add(b.t, rate);
    }
    if (b.interpolated) continue;
    turn(b.t, b.gyro_B - now_.bias_gyro);
    samples.push_back(b);
  }
  return samples;
}

Preintegration ImuPropagator::predict(std::vector<ImuSample> imu, bool started) {
  const ImuNoise& noise = noise_.add(imu);
  if (started && std::ranges::adjacent_find(imu, in_gap) != imu.end()) imu = bridged(imu);
  Preintegration motion(imu, now_.bias_gyro, now_.bias_accel, noise);
  const Timestamp t = motion.end();
  gyro_was_saturated_ = gyro_saturated_ && !motion.gyro_clipped();
  gyro_saturated_ = motion.gyro_clipped();
  started_ = started;
  predicted_s_ = started && motion.gyro_trusted() ? motion.dt() : 0.0;
  gap_s_ = started ? motion.gap_s() : 0.0;
  const auto last = std::ranges::find(imu.rbegin(), imu.rend(), false, &ImuSample::interpolated);
  silent_s_ = last == imu.rbegin() ? 0.0 : last == imu.rend() ? silent_s_ + motion.dt() : to_seconds(t - last->t);
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
  if (gap_s_ > 0.0 && silent_s_ > 0.0 && !new_frame)  // only the cameras measure the rate
    omega_B_ += so3::log(now_.T_O_B.rotation().conjugate() * estimate.T_O_B.rotation()) / gap_s_;
  if (!new_frame && !standstill && predicted_s_ > 0.0)
    noise_.add_correction(now_.t, estimate.v_O - now_.v_O, predicted_s_);
  now_ = estimate;
  for (StampedPose& pose : T_O_B_) pose.T = correction * pose.T;
  return correction;
}

}  // namespace edged
