// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/imu_interpolator.hpp"

namespace edged {
namespace {

constexpr Duration kLongestStep = std::chrono::milliseconds(100);  // between two samples of the accelerometer
constexpr std::size_t kMostWaiting = 10'000;

}  // namespace

std::vector<ImuSample> ImuInterpolator::add_gyro(Timestamp t, const Eigen::Vector3d& gyro) {
  if (!gyro_.empty() && t <= gyro_.back().first) return {};
  gyro_.emplace_back(t, gyro);
  if (gyro_.size() > kMostWaiting) gyro_.pop_front();
  return complete();
}

std::vector<ImuSample> ImuInterpolator::add_accel(Timestamp t, const Eigen::Vector3d& accel) {
  if (!accel_.empty() && t <= accel_.back().first) return {};
  accel_.emplace_back(t, accel);
  if (accel_.size() > kMostWaiting) accel_.pop_front();
  return complete();
}

std::vector<ImuSample> ImuInterpolator::complete() {
  std::vector<ImuSample> samples;
  while (!gyro_.empty() && !accel_.empty() && gyro_.front().first <= accel_.back().first) {
    const auto [t, gyro] = gyro_.front();
    gyro_.pop_front();
    while (accel_.size() > 1 && accel_[1].first <= t) accel_.pop_front();
    const auto& [t_0, a_0] = accel_.front();
    if (t_0 == t) {
      samples.push_back({t, gyro, a_0});
    } else if (accel_.size() > 1 && t_0 < t && accel_[1].first - t_0 <= kLongestStep) {
      const double share = to_seconds(t - t_0) / to_seconds(accel_[1].first - t_0);
      samples.push_back({t, gyro, a_0 + share * (accel_[1].second - a_0)});
    }
  }
  return samples;
}

}  // namespace edged
