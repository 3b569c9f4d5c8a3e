// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks whether the axes of the accelerometer are those of the gyro.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <deque>
#include <optional>
#include <string>

#include "edged/measurement.hpp"

namespace edged {

/// When the body rotates, gravity rotates in the opposite direction in the axes of the body. If this holds only after
/// sign changes or exchanges of accelerometer axes, these contradict the gyro. (Negating the third axis is equivalent
/// to negating both others. Negating all three is not observable.) The unit of the gyro must be correct. Memory is
/// bounded.
class AccelAxes {
 public:
  AccelAxes();

  void add(const ImuSample& sample);

  /// The axes that would make the two agree, such as "(-x, y, z)"; nothing if they agree, or after too little rotation.
  std::optional<std::string> better() const;

 private:
  /// Mean over a part of a second.
  struct Mean {
    Timestamp begin;
    Eigen::Quaterniond q_0_B = Eigen::Quaterniond::Identity();  ///< at its middle, relative to the first sample
    Eigen::Vector3d accel = Eigen::Vector3d::Zero();
    std::size_t count = 0;
  };

  void end_mean();

  std::array<Eigen::Matrix3d, 24> axes_;  ///< candidates, from the given ones; the first are those
  std::array<double, 24> errors_{};       ///< sum of squares, one for each of them [m^2/s^4]
  double unturned_ = 0.0;                 ///< the same if the specific force did not turn in the body
  std::size_t pairs_ = 0;
  std::optional<ImuSample> last_;
  Eigen::Quaterniond q_0_B_ = Eigen::Quaterniond::Identity();
  Mean current_;
  std::deque<Mean> means_;  ///< the newest
};

}  // namespace edged
