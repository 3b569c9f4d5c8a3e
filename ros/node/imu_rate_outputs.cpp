// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/imu_rate_outputs.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "edged/core/check.hpp"

namespace edged::node {
namespace {

constexpr std::size_t kImuQueue = 200;  // messages that may wait for a slow subscriber
constexpr Duration kRecentImu = std::chrono::seconds(2);

}  // namespace

ImuRateOutputs::ImuRateOutputs(Transport& transport, const NodeConfig& config, double gyro_noise)
    : format_{transport.wire(), config.frame_names()},
      gyro_noise_(gyro_noise),
      topic_(transport.advertise({"~/prediction", "nav_msgs/Odometry", kImuQueue})),
      stream_(config.autopilot) {
  if (!config.mavlink.empty()) mavlink_ = std::make_unique<MavlinkOutput>(config.mavlink, config.autopilot);
  if (!config.publish_px4) return;
  if (transport.wire() != Wire::Cdr) throw InputError("publish_px4: PX4 has topics of ROS 2 only: use mavlink");
  px4_ = transport.advertise({"/fmu/in/vehicle_visual_odometry", "px4_msgs/VehicleOdometry", 1, false, false});
}

void ImuRateOutputs::add(const ImuSample& sample, Duration set_by) {
  const std::lock_guard lock(mutex_);
  keep(sample);
  prediction_.add(sample);
  const std::optional<NavState> state = prediction_.newest();
  if (!state || state->t != sample.t) return;  // a late sample is ignored
  if (mavlink_ || px4_) send_to_autopilot(*state, sample);
  if (!T_B_base_) return;
  Estimate base = at(*T_B_base_, {*state, sample.gyro_B, covariance_, gyro_sigma()});
  base.state.t += set_by;
  topic_->publish(odometry_message(format_, in(T_map_odom_.inverse(), base)));
}

void ImuRateOutputs::send_to_autopilot(const NavState& state, const ImuSample& sample) {
  clock_.arrived(sample.t, MavlinkOutput::unix_now());
  const Duration now = clock_.at(state.t);
  if (mavlink_) mavlink_->send(state, sample.gyro_B, now);
  if (!px4_) return;
  if (const auto odometry = stream_.next(state, sample.gyro_B, now)) px4_->publish(vehicle_odometry_message(*odometry));
}

void ImuRateOutputs::keep(const ImuSample& sample) {
  const Duration back = recent_.empty() ? Duration(0) : recent_.back().t - sample.t;
  if (back > kRecentImu) {
    spdlog::warn(
        fmt::format("the clock of the IMU has jumped back by {:.1f} s: the estimate starts again once the clocks of "
                    "all sensors have jumped back",
                    to_seconds(back)));
    recent_.clear();
  }
  if (recent_.empty() || sample.t > recent_.back().t) recent_.push_back(sample);
  while (sample.t - recent_.front().t > kRecentImu) recent_.pop_front();
}

void ImuRateOutputs::note(const Step& step, const SE3& T_map_odom, const std::optional<SE3>& T_B_base) {
  const std::lock_guard lock(mutex_);
  T_map_odom_ = T_map_odom;
  T_B_base_ = T_B_base;
  prediction_.correct(is_tracking(step.status) ? std::optional(step.state) : std::nullopt);
  if (mavlink_) mavlink_->note(step);
  stream_.note(step);
  covariance_ = step.covariance;
}

void ImuRateOutputs::forget() {
  const std::lock_guard lock(mutex_);
  prediction_.correct(std::nullopt);
  covariance_.reset();
}

Estimate ImuRateOutputs::estimate_of(const Step& step) const {
  const std::lock_guard lock(mutex_);
  const auto last = std::ranges::find_if(recent_.rbegin(), recent_.rend(),
                                         [&step](const ImuSample& sample) { return sample.t <= step.t; });
  const Eigen::Vector3d gyro_B = last == recent_.rend() ? Eigen::Vector3d::Zero().eval() : last->gyro_B;
  return {step.state, gyro_B, step.covariance, gyro_sigma()};
}

/// That of one sample, by the noise density and the rate of the IMU [rad/s].
double ImuRateOutputs::gyro_sigma() const {
  if (recent_.size() < 2) return 0.0;
  const double span_s = to_seconds(recent_.back().t - recent_.front().t);
  return gyro_noise_ * std::sqrt(static_cast<double>(recent_.size() - 1) / span_s);
}

std::optional<Timestamp> ImuRateOutputs::newest() const {
  const std::lock_guard lock(mutex_);
  return recent_.empty() ? std::nullopt : std::optional(recent_.back().t);
}

}  // namespace edged::node
