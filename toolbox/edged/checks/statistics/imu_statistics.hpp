// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Statistics of the IMU: noise, rest and units.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "edged/measurement.hpp"

namespace edged {

/// Readings that a sensor of three axes repeats to the last bit. The noise of a working one prevents this.
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

/// Samples of one sensor, in time order.
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

/// Means of the half second in which the gyro varies least.
struct ImuCalm {
  Timestamp begin;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// The longest time at rest, of whole half seconds. The noise is the Allan deviation of means over 50 ms, as a density:
/// a band of about 10 Hz, above the bias random walk and below the cut-off of most IMU filters.
struct ImuRest {
  Timestamp begin;
  Duration length{0};
  double gyro_noise = 0.0;                          ///< [rad/s/sqrt(Hz)]
  double accel_noise = 0.0;                         ///< [m/s^2/sqrt(Hz)]
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< mean: the gyro bias [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< mean: upwards [m/s^2]
};

struct ImuStatistics {
  std::optional<ImuCalm> calm;             ///< nothing if no half second has samples in all of its parts
  std::optional<ImuRest> rest;             ///< nothing without rest, as motion hides the noise
  double mean_accel = 0.0;                 ///< length of the specific force [m/s^2]
  double mean_gyro = 0.0, max_gyro = 0.0;  ///< angular speed [rad/s]
  FrozenReadings gyro_frozen, accel_frozen;
};

/// Samples must be in time order. Memory is bounded.
class ImuCollector {
 public:
  void add(const ImuSample& sample);
  /// To be called while the image of a camera moves: then a constant rate is a rotation, not a bias.
  void image_moves() { image_moves_ = true; }
  ImuStatistics result() const;

 private:
  /// Sums of samples, or of means of samples.
  struct Sums {
    std::size_t count = 0;
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    double gyro_squares = 0.0, accel_squares = 0.0;  ///< sums over all three axes

    void add(const Eigen::Vector3d& w, const Eigen::Vector3d& a);
    void add(const Sums& other);
  };
  /// Consecutive means over 50 ms without a gap.
  struct Stretch {
    Timestamp begin, end;
    Sums means, differences;   ///< differences: of successive means
    bool image_moves = false;  ///< at some time in this stretch
  };

  void end_part();
  void end_stretch();
  static bool at_rest(const Stretch& stretch);

  bool image_moves_ = false;  ///< since the last stretch
  Timestamp part_begin_;
  Sums part_;
  std::optional<Stretch> current_, calmest_, rest_, longest_rest_;
  Eigen::Vector3d last_gyro_ = Eigen::Vector3d::Zero(),
                  last_accel_ = Eigen::Vector3d::Zero();  ///< means of the last part
  FrozenDetector gyro_frozen_, accel_frozen_;
  std::size_t count_ = 0;
  double accel_sum_ = 0.0, gyro_sum_ = 0.0, max_gyro_ = 0.0;
};

}  // namespace edged
