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

/// A sample has the stamp of the gyro, with the accelerometer interpolated linearly. Gyro samples without an
/// accelerometer sample on both sides, or within a gap of these, are left out. Each stream must be in time order.
class ImuInterpolator {
 public:
  /// Returns the samples that are complete now.
  std::vector<ImuSample> add_gyro(Timestamp t, const Eigen::Vector3d& gyro);
  std::vector<ImuSample> add_accel(Timestamp t, const Eigen::Vector3d& accel);

 private:
  using Reading = std::pair<Timestamp, Eigen::Vector3d>;
  std::vector<ImuSample> complete();

  std::deque<Reading> gyro_;   ///< samples that wait for the accelerometer
  std::deque<Reading> accel_;  ///< the last sample before the first of gyro_, and all later ones
};

}  // namespace edged
