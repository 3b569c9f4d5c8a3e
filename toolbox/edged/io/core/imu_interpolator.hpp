// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges a gyro stream and an accelerometer stream into IMU samples. Internal to io.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// A sample has the stamp of the gyro, with the accelerometer interpolated linearly. Gyro samples without an
/// accelerometer sample on both sides, or within a gap of these, are left out. Each stream must be in time order.
class ImuInterpolator {
 public:
  /// Returns the samples that are complete now.
  std::vector<ImuSample> add_gyro(Timestamp t, const Eigen::Vector3d& gyro) { return add(gyro_, t, gyro); }
  std::vector<ImuSample> add_accel(Timestamp t, const Eigen::Vector3d& accel) { return add(accel_, t, accel); }

 private:
  using Readings = std::deque<std::pair<Timestamp, Eigen::Vector3d>>;
  static constexpr Duration kLongestStep = std::chrono::milliseconds(100);  ///< between samples of the accelerometer
  static constexpr std::size_t kMostWaiting = 10'000;

  std::vector<ImuSample> add(Readings& to, Timestamp t, const Eigen::Vector3d& reading) {
    if (!to.empty() && t <= to.back().first) return {};
    to.emplace_back(t, reading);
    if (to.size() > kMostWaiting) to.pop_front();
    return complete();
  }

  std::vector<ImuSample> complete() {
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

  Readings gyro_;   ///< samples that wait for the accelerometer
  Readings accel_;  ///< the last sample before the first of gyro_, and all later ones
};

}  // namespace edged
