// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects a sensor of three axes that repeats its readings to the last bit. The noise of a working sensor prevents
// this.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "edged/time.hpp"

namespace edged {

struct FrozenReadings {
  Duration covered{0};                              ///< from the first to the last sample
  Duration longest{0};                              ///< the longest time in which no axis changed
  Timestamp since;                                  ///< begin of that time
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< reading in that time
  std::array<Duration, 3> axes{};                   ///< the longest time in which that axis did not change

  /// True if no axis changes, except for a short part.
  bool dead() const { return is_whole(longest); }
  bool dead(std::size_t axis) const { return is_whole(axes.at(axis)); }

 private:
  bool is_whole(Duration constant) const {
    return covered >= std::chrono::milliseconds(500) && constant >= covered * 9 / 10;
  }
};

/// Samples must be in time order. Memory is bounded.
class FrozenDetector {
 public:
  void add(Timestamp t, const Eigen::Vector3d& value);
  const FrozenReadings& result() const { return result_; }

 private:
  bool begun_ = false;
  Timestamp first_, all_since_;
  std::array<Timestamp, 3> axis_since_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  FrozenReadings result_;
};

}  // namespace edged
