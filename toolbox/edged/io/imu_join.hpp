// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges a gyro stream and an accelerometer stream into IMU samples. Internal to io.
#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// At the stamps of the gyro, the accelerometer interpolated linearly between its samples. Gyro samples without such a
/// sample on both sides, or in a gap between two, are left out. Each comes in time order.
class ImuJoin {
 public:
  /// Returns the samples that are complete now.
  std::vector<ImuSample> add_gyro(Timestamp t, const Eigen::Vector3d& gyro);
  std::vector<ImuSample> add_accel(Timestamp t, const Eigen::Vector3d& accel);

 private:
  using Reading = std::pair<Timestamp, Eigen::Vector3d>;
  std::vector<ImuSample> complete();

  std::deque<Reading> gyro_;   ///< that wait for the accelerometer
  std::deque<Reading> accel_;  ///< the last before the first of those, and what follows
};

}  // namespace edged
