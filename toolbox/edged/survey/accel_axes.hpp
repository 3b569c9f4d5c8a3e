// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the accelerometer's axes are those of the gyro.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <deque>
#include <optional>
#include <string>

#include "edged/measurement.hpp"

namespace edged {

/// As the body turns, gravity turns the other way round in its axes. Where it does so only after the accelerometer's
/// axes change signs, these are wrong against the gyro's. (The third is the same as both others; all three cannot be
/// told: down for up.) The unit of the gyro must be right. Memory is bounded.
class AccelAxes {
 public:
  AccelAxes();

  void add(const ImuSample& sample);

  /// What would make the two agree, such as "(-x, y, z)"; nothing while they agree as they are, or too little turned.
  std::optional<std::string> better() const;

 private:
  /// Mean over a part of a second.
  struct Mean {
    Timestamp begin;
    Eigen::Quaterniond q_0_B = Eigen::Quaterniond::Identity();  ///< in its middle, against the first sample
    Eigen::Vector3d accel = Eigen::Vector3d::Zero();
    std::size_t count = 0;
  };

  void end_mean();

  std::array<Eigen::Vector3d, 4> signs_;  ///< of the axes; as they are first
  std::array<double, 4> errors_{};        ///< sum of squares, one for each signs [m^2/s^4]
  std::size_t pairs_ = 0;
  std::optional<ImuSample> last_;
  Eigen::Quaterniond q_0_B_ = Eigen::Quaterniond::Identity();
  Mean current_;
  std::deque<Mean> means_;  ///< the newest
};

}  // namespace edged
