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
#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"
#include "edged/options/estimator.hpp"
#include "edged/state.hpp"

namespace edged {

/// What the estimate knows of the body's motion, without the images of the packet.
struct KnownMotion {
  double speed = 0.0, speed_sigma = 0.0;  ///< [m/s] sigma of the worst direction
  double rate_sigma = 0.0;                ///< [rad/s] of a rate by the gyro, less its bias
  std::optional<double> depth_m = {};     ///< median depth of the landmarks in view
};

class StandstillDetector {
 public:
  using MotionSource = std::function<std::optional<KnownMotion>()>;

  StandstillDetector(const StandstillConfig& config, const ImuNoise& calibrated)
      : config_(config), calibrated_(calibrated), noise_(calibrated), image_(config.window_s) {}

  /// Vibration is no motion: with the next packets the IMU may shake as much as this noise.
  void set_noise(const ImuNoise& in_use) { noise_ = in_use; }

  /// Takes one packet: its IMU, its features, and whether the event camera is quiet (static view). bias_gyro: its
  /// estimate; a mean rate beyond it may be a steady turn. motion: what is known of it, asked for where it decides;
  /// nothing before the start.
  void add(
      const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations, bool events_quiet,
      const Eigen::Vector3d& bias_gyro = Eigen::Vector3d::Zero(),
      const MotionSource& motion = [] { return std::nullopt; });

  /// True when the whole window was at rest.
  bool still() const { return still_; }
  /// True at standstill if the IMU has been as quiet as its own noise: it needs no still images then.
  bool still_by_imu() const { return quiet_; }
  /// True if the image has been static for a while although the IMU is not calm, or has a gap.
  bool image_static() const { return image_static_; }
  /// The IMU shakes more than at its calibration.
  bool vibrates() const;
  /// The noise of the IMU during a rest that has lasted for a while.
  const std::optional<ImuNoise>& noise_at_rest() const { return noise_at_rest_; }
  /// Why it is no standstill, with numbers; empty at standstill.
  const std::string& reason() const { return reason_; }
  /// Means over mean_duration_s(), the window or a rest that shakes; meaningful at rest.
  const Eigen::Vector3d& mean_gyro_B() const { return mean_gyro_; }
  const Eigen::Vector3d& mean_accel_B() const { return mean_accel_; }
  double mean_duration_s() const { return mean_duration_s_; }
  /// Errors by vibration of means over so many seconds.
  double mean_gyro_sigma(double duration_s) const { return vibration(&ImuNoise::gyro_noise) / std::sqrt(duration_s); }
  double mean_accel_sigma(double duration_s) const { return vibration(&ImuNoise::accel_noise) / std::sqrt(duration_s); }

 private:
  /// Means of the samples over the last part of the window, and the spread of its block means.
  struct Spread {
    double covered_s = 0.0;
    double gyro = 0.0, accel = 0.0;  ///< [rad/s], [m/s^2]
    Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero(), mean_accel = Eigen::Vector3d::Zero();
  };
  void buffer(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations,
              bool events_quiet);
  void judge_shaking(const Spread& spread, bool gap, const MotionSource& motion);
  void judge_calm(const MotionSource& motion);
  void measure_rest();
  void take_means(const Spread& spread);
  Spread spread_over(double window_s) const;
  double vibration(double ImuNoise::*density) const;
  double rate() const { return (mean_gyro_ - bias_gyro_).norm(); }  ///< [rad/s] mean rate less the known bias
  /// The largest spread of block means at rest: the given one and what vibration adds.
  double max_gyro_spread() const;
  double max_accel_spread() const;
  bool imu_calm(const Spread& spread);
  bool imu_quiet(double window_s);
  bool image_still();
  bool hidden_from_image(const KnownMotion& motion);
  bool explains_image(const std::optional<KnownMotion>& motion);
  bool moves(const KnownMotion& motion);
  bool image_turns();
  bool only_shakes(const Spread& spread);

  StandstillConfig config_;
  ImuNoise calibrated_, noise_;  ///< noise_: in use
  std::deque<ImuSample> imu_;
  ImageMotion image_;
  bool still_ = false, quiet_ = false, image_static_ = false;
  std::optional<Timestamp> shakes_since_, rests_since_, measured_at_;
  std::optional<ImuNoise> noise_at_rest_;
  std::string reason_;
  Eigen::Vector3d bias_gyro_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_gyro_ = Eigen::Vector3d::Zero(), mean_accel_ = Eigen::Vector3d::Zero();
  double mean_duration_s_ = 0.0;
};

}  // namespace edged
