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

/// Integrated gyro, and the specific force along with it.
class GyroIntegral {
 public:
  void add(const ImuSample& sample);
  /// The rotation vector of the body between two stamps, for turns small enough to be added: whatever the unit of the
  /// gyro. Nothing where samples are missing.
  std::optional<Eigen::Vector3d> between(Timestamp begin, Timestamp end) const;
  /// The same for any turn: R_W_B(end) = R_W_B(begin) * Exp(it).
  std::optional<Eigen::Vector3d> turn_between(Timestamp begin, Timestamp end) const;
  /// The rotation relative to the first sample, and the integral of the specific force in those axes between two stamps
  /// [m/s]: the change of velocity plus the reaction to gravity.
  std::optional<Eigen::Quaterniond> attitude_at(Timestamp t) const;
  std::optional<Eigen::Vector3d> pushed_between(Timestamp begin, Timestamp end) const;
  bool empty() const { return stamps_.empty(); }
  Timestamp first() const { return stamps_.front(); }  ///< of one that is not empty
  Timestamp last() const { return stamps_.back(); }

 private:
  /// The first sample after each of two stamps.
  std::optional<std::pair<std::size_t, std::size_t>> samples_after(Timestamp begin, Timestamp end) const;
  /// From the sample `after` - 1 to t, which lies before the next one.
  Eigen::Vector3d step_to(std::size_t after, Timestamp t) const;

  std::vector<Timestamp> stamps_;
  std::vector<Eigen::Vector3d> gyro_, sum_, accel_, push_;
  std::vector<Eigen::Quaterniond> turned_;  ///< since the first sample
};

}  // namespace edged
