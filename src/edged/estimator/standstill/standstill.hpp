// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects a standstill of the body: a hypothesis that IMU, images and the estimate of the motion must support together.
// Still images and a calm IMU confirm it, unless the estimate moves so slowly that the images could not show it. Images
// that move do so by dynamic objects only if the IMU has been as quiet as its own noise for a while, and if the motion
// that the estimate allows does not explain them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/estimator/standstill/image_motion.hpp"
#include "edged/measurement.hpp"
#include "edged/options/estimator.hpp"
#include "edged/state.hpp"

namespace edged {

/// White noise of the IMU beyond the calibrated one, as motors cause it: densities as in ImuNoise.
struct Vibration {
  double gyro_noise = 0.0, accel_noise = 0.0;
};

/// What the estimate knows of the body's motion, without the images of the packet.
struct KnownMotion {
  double speed = 0.0, speed_sigma = 0.0;  ///< [m/s] sigma of the worst direction
  double rate_sigma = 0.0;                ///< [rad/s] of a rate by the gyro, less its bias
  std::optional<double> depth_m = {};     ///< median depth of the landmarks in view
};

class StandstillDetector {
 public:
  explicit StandstillDetector(const StandstillConfig& config) : config_(config), image_(config.window_s) {}

  /// Vibration is no motion: with the next packets the IMU may shake as much.
  void set_vibration(const Vibration& vibration) { vibration_ = vibration; }

  /// Takes one packet: its IMU, its features, and whether the event camera is quiet (static view). bias_gyro: its
  /// estimate; a mean rate beyond it may be a steady turn. motion: what is known of it, asked for where it decides;
  /// nothing before the start.
  void add(
      const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations, bool events_quiet,
      const Eigen::Vector3d& bias_gyro = Eigen::Vector3d::Zero(),
      const std::function<std::optional<KnownMotion>()>& motion = [] { return std::nullopt; });

  /// True when the whole window was at rest.
  bool still() const { return still_; }
  /// True at standstill if the IMU has been as quiet as its own noise: it needs no still images then.
  bool still_by_imu() const { return quiet_; }
  /// True if the image has been static for a while although the IMU is not calm, or has a gap: rest on something that
  /// shakes, or motion too slow to see.
  bool image_static() const { return image_static_; }
  /// True at rest, also on something that shakes: a start needs no more.
  bool at_rest() const { return still_ || shaken_; }
  /// Why it is no standstill, with numbers; empty at standstill.
  const std::string& reason() const { return reason_; }
  /// Means over the window; meaningful at rest.
  const Eigen::Vector3d& mean_gyro_B() const { return mean_gyro_; }
  const Eigen::Vector3d& mean_accel_B() const { return mean_accel_; }
  /// Errors by the vibration of means over so many seconds.
  double mean_gyro_sigma(double duration_s) const { return vibration_.gyro_noise / std::sqrt(duration_s); }
  double mean_accel_sigma(double duration_s) const { return vibration_.accel_noise / std::sqrt(duration_s); }

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
  /// The largest spread of block means at rest: the given one and what vibration adds.
  double max_gyro_spread() const;
  double max_accel_spread() const;
  bool imu_calm(const Spread& spread);
  bool imu_quiet(double window_s);
  bool image_still();
  bool hidden_from_image(const KnownMotion& motion);
  bool explains_image(const std::optional<KnownMotion>& motion);
  bool moves(const KnownMotion& motion);
  bool image_turns(const Eigen::Vector3d& rate);
  bool only_shakes(const Spread& spread);

  StandstillConfig config_;
  Vibration vibration_;
  std::deque<ImuSample> imu_;
  ImageMotion image_;
  bool still_ = false, quiet_ = false, image_static_ = false, shaken_ = false;
  std::optional<Timestamp> shakes_since_;
  std::string reason_;
  double rate_ = 0.0;  ///< [rad/s] mean rate less the known bias
  Eigen::Vector3d mean_gyro_ = Eigen::Vector3d::Zero(), mean_accel_ = Eigen::Vector3d::Zero();
};

}  // namespace edged
