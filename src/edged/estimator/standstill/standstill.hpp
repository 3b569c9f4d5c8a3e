// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects a standstill of the body. The IMU alone suffices if it has been as quiet as its own noise for a while, as a
// camera at rest may show only dynamic objects. If the IMU has only been calm, for a shorter time, still images must
// confirm it.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/measurement.hpp"
#include "edged/options/estimator.hpp"
#include "edged/state.hpp"

namespace edged {

class StandstillDetector {
 public:
  explicit StandstillDetector(const StandstillConfig& config) : config_(config) {}

  /// Takes one packet: its IMU, its features, and whether the event camera is quiet (static view). bias_gyro: its
  /// estimate; a mean rate beyond it may be a steady turn.
  void add(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations, bool events_quiet,
           const Eigen::Vector3d& bias_gyro = Eigen::Vector3d::Zero());

  /// True when the whole window was at rest.
  bool still() const { return still_; }
  /// True when the IMU alone detects it, independent of cameras and estimate.
  bool still_by_imu() const { return quiet_; }
  /// True if the image has been static for a while although the IMU is not calm: rest on something that shakes, or
  /// motion too slow to see.
  bool image_static() const { return image_static_; }
  /// Why it is no standstill, with numbers; empty at standstill.
  const std::string& reason() const { return reason_; }
  /// Means over the window; meaningful when still.
  const Eigen::Vector3d& mean_gyro_B() const { return mean_gyro_; }
  const Eigen::Vector3d& mean_accel_B() const { return mean_accel_; }

 private:
  /// Means of the samples over the last part of the window, and the spread of its block means.
  struct Spread {
    double covered_s = 0.0;
    double gyro = 0.0, accel = 0.0;  ///< [rad/s], [m/s^2]
    Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero(), mean_accel = Eigen::Vector3d::Zero();
  };
  void buffer(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations,
              bool events_quiet);
  Spread spread_over(double window_s) const;
  bool imu_calm(const Spread& spread);
  bool imu_quiet(double window_s);
  bool image_still();
  bool image_glides() const;
  bool image_turns(const Eigen::Vector3d& rate) const;
  bool only_shakes(const Spread& spread) const;
  std::vector<Eigen::Vector2d> travels() const;
  std::optional<double> median_travel() const;

  struct View {
    Timestamp t;
    std::map<FeatureId, Eigen::Vector2d> points;
    bool events_quiet = false;
  };

  StandstillConfig config_;
  std::deque<ImuSample> imu_;
  std::deque<View> views_;
  bool still_ = false, quiet_ = false, image_static_ = false;
  std::optional<Timestamp> shakes_since_;
  std::string reason_;
  Eigen::Vector3d mean_gyro_ = Eigen::Vector3d::Zero(), mean_accel_ = Eigen::Vector3d::Zero();
};

}  // namespace edged
