// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tells whether the body rests, from the spread of the IMU readings and from what the cameras see; both must agree.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "edged/core/config.hpp"
#include "edged/core/types.hpp"

namespace edged {

struct StandstillConfig {
  double window_s = 0.4;           ///< the body must have rested for this long
  double max_gyro = 0.03;          ///< spread of the angular rate's block means [rad/s]
  double max_accel = 0.25;         ///< spread of the acceleration's block means [m/s^2]
  double max_gyro_mean = 0.15;     ///< a mean rate above this is motion, not bias [rad/s]
  double max_image_motion = 4e-3;  ///< median travel of the corners over the window, on the unit plane [rad]
  void visit(ConfigFields& fields);
};

class StandstillDetector {
 public:
  explicit StandstillDetector(const StandstillConfig& config) : config_(config) {}

  /// Takes one packet: its IMU, its corners, and whether the event camera is quiet (nothing moves in its view).
  void add(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations, bool events_quiet);

  /// True when the whole window was at rest.
  bool still() const { return still_; }
  /// What keeps it from being called rest, with numbers; empty when still.
  const std::string& reason() const { return reason_; }
  /// Means over the window; meaningful when still.
  const Eigen::Vector3d& mean_gyro_B() const { return mean_gyro_; }
  const Eigen::Vector3d& mean_accel_B() const { return mean_accel_; }

 private:
  bool imu_still();
  bool image_still();

  struct View {
    Timestamp t;
    std::map<FeatureId, Eigen::Vector2d> points;
    bool events_quiet = false;
  };

  StandstillConfig config_;
  std::deque<ImuSample> imu_;
  std::deque<View> views_;
  bool still_ = false;
  std::string reason_;
  Eigen::Vector3d mean_gyro_ = Eigen::Vector3d::Zero(), mean_accel_ = Eigen::Vector3d::Zero();
};

}  // namespace edged
