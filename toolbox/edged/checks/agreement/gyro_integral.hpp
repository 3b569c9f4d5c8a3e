// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The rotation of the body between any two stamps, from its gyro.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/se3.hpp"

namespace edged {

/// The integral of the gyro, and of the specific force.
class GyroIntegral {
 public:
  void add(const ImuSample& sample);
  /// The rotation vector of the body between two stamps as the sum of the readings, for small rotations and any unit of
  /// the gyro. Nothing if samples are missing.
  std::optional<Eigen::Vector3d> between(Timestamp begin, Timestamp end) const;
  /// The rotation vector for any rotation: R_W_B(end) = R_W_B(begin) * Exp(result).
  std::optional<Eigen::Vector3d> rotation_vector(Timestamp begin, Timestamp end) const;
  /// The rotation relative to the first sample, and the integral of the specific force in those axes between two stamps
  /// [m/s]: the change of velocity plus the reaction to gravity.
  std::optional<Eigen::Quaterniond> attitude_at(Timestamp t) const;
  std::optional<Eigen::Vector3d> velocity_change(Timestamp begin, Timestamp end) const;
  bool empty() const { return stamps_.empty(); }
  Timestamp first() const { return stamps_.front(); }  ///< must not be empty
  Timestamp last() const { return stamps_.back(); }

 private:
  /// The first sample after each of two stamps.
  std::optional<std::pair<std::size_t, std::size_t>> samples_after(Timestamp begin, Timestamp end) const;
  /// The integral from the sample `after` - 1 to t, which is before the next sample.
  Eigen::Vector3d step_to(std::size_t after, Timestamp t) const;

  std::vector<Timestamp> stamps_;
  std::vector<int> gaps_;  ///< up to each sample
  std::vector<Eigen::Vector3d> gyro_, sum_, accel_, velocity_;
  std::vector<Eigen::Quaterniond> attitude_;  ///< since the first sample
};

}  // namespace edged
