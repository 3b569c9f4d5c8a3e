// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options/estimator.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <sstream>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

Eigen::Vector3d three_numbers(const std::string& text, std::string_view key) {
  std::string spaced = text;
  std::ranges::replace(spaced, ',', ' ');
  std::istringstream in(spaced);
  Eigen::Vector3d numbers;
  std::string rest;
  if (!(in >> numbers.x() >> numbers.y() >> numbers.z()) || in >> rest || !numbers.allFinite()) {
    throw InputError(fmt::format("{}: '{}' is no three numbers such as \"0.1 0 -0.05\"", key, text));
  }
  return numbers;
}

}  // namespace

void HeightConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled, {.effect = "use the samples of a height sensor, where there are any"});
  fields.add("sigma_m", sigma_m, {"m", 1e-3, 100, "noise (standard deviation) of samples that come without their own"});
  fields.add("bias_walk", bias_walk, {"m/sqrt(s)", 0, 10, "how fast the level that heights are above drifts"});
}

void VelocityConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled, {.effect = "use the samples of a velocity sensor, where there are any"});
  fields.add("sigma_mps", sigma_mps,
             {"m/s", 1e-3, 100, "noise (standard deviation) of samples that come without their own"});
  fields.add("position_m", position_m,
             {.unit = "m", .effect = "where the velocity sensor is in the body frame: x y z"});
  fields.add("rotation_deg", rotation_deg,
             {.unit = "deg", .effect = "how its axes are turned against the body frame: roll pitch yaw"});
}

SE3 VelocityConfig::T_B_S() const {
  const Eigen::Vector3d angles = kDegree * three_numbers(rotation_deg, "velocity.rotation_deg");
  const Eigen::Quaterniond R_B_S = so3::exp(Eigen::Vector3d(0.0, 0.0, angles.z())) *
                                   so3::exp(Eigen::Vector3d(0.0, angles.y(), 0.0)) *
                                   so3::exp(Eigen::Vector3d(angles.x(), 0.0, 0.0));
  return {R_B_S, three_numbers(position_m, "velocity.position_m")};
}

void CalibrationConfig::visit(ConfigFields& fields) {
  fields.add("rotation_sigma_deg", rotation_sigma_deg,
             {"deg", 0, 10, "how far each camera's rotation against the IMU may be off; 0 holds it as given"});
  fields.add("time_offset_sigma_ms", time_offset_sigma_ms,
             {"ms", 0, 50, "how far each camera's time offset may be off; 0 holds it as given"});
  fields.add(
      "imu_sigma", imu_sigma,
      {"1", 0, 0.1, "how far scale and axes of gyro and accelerometer may be off, as a share; 0 holds them as given"});
}

void TrackNoise::visit(ConfigFields& fields) {
  fields.add(
      "correlation", correlation,
      {"1", 0, 0.999, "of the errors of two observations of a track right after one another; 0: all independent"});
  fields.add("event_correlation", event_correlation,
             {"1", 0, 0.999,
              "the same on event frames; higher: more accurate where all stands still, and what moves "
              "slowly is believed"});
  fields.add("time_s", time_s, {"s", 0.01, 1000, "after this time the correlation has fallen to 1/e of that"});
}

void EstimatorConfig::visit(ConfigFields& fields) {
  fields.add("recent_states", recent_states, {"", 1, 20, "newest states in the window, keyframes or not"});
  fields.add("keyframes", keyframes, {"", 2, 30, "older keyframes in the window; more are slower and more accurate"});
  fields.add("max_interval_s", max_interval_s,
             {"s", 0.2, 10, "after this time a state becomes a keyframe in any case"});
  fields.add("iterations", iterations, {"", 1, 50, "solver iterations a packet"});
  fields.add("cauchy_scale", cauchy_scale, {"sigma", 0.1, 100, "visual residuals beyond this are weighted down"});
  fields.add("gyro_bias_sigma", gyro_bias_sigma,
             {"rad/s", 1e-5, 1, "how far the gyro bias may lie from the guess of a start in motion"});
  fields.add("rest_gyro_bias_sigma", rest_gyro_bias_sigma,
             {"rad/s", 1e-5, 1, "how far the gyro bias may lie from the mean rate measured at rest"});
  fields.add("accel_bias_sigma", accel_bias_sigma,
             {"m/s^2", 1e-4, 5, "how far the accelerometer bias may lie from zero"});
  fields.add("zero_velocity_sigma", zero_velocity_sigma, {"m/s", 1e-4, 1, "how still a standstill is"});
  fields.add("init_spacing_s", init_spacing_s, {"s", 0.01, 1, "time between the newest views of a start in motion"});
  fields.add("init_turn_deg", init_turn_deg, {"deg", 0.5, 90, "turning by this makes the next of these views sooner"});
  fields.add("init_min_views", init_min_views, {"", 5, 30, "views a start in motion needs at least"});
  fields.add("init_max_views", init_max_views, {"", 5, 60, "views a start in motion looks back on at most"});
  fields.add("init_max_span_s", init_max_span_s, {"s", 0.5, 60, "time a start in motion looks back on at most"});
  fields.add("init_scale_sigma", init_scale_sigma,
             {"", 0.01, 1,
              "how well a start in motion must know the scale to be Good, as a share of it (standard deviation)"});
  fields.add("provisional_scale_sigma", provisional_scale_sigma,
             {"", 0.01, 1, "knowing it only to this, a start is used, Degraded, and refined"});
  fields.add("noise_gain", noise_gain, {"", 0, 1, "speed of adapting each camera's noise to its residuals; 0: fixed"});
  fields.add("noise_inflation", noise_inflation,
             {"", 0.5, 20, "assumed noise over the spread of what each observation adds to the one before"});
  fields.add("event_noise_inflation", event_noise_inflation,
             {"", 0.5, 20, "the same for event cameras beside frames: times noise_inflation"});
  fields.add("min_noise_scale", min_noise_scale, {"", 0.001, 1, "least adapted noise over the configured one"});
  fields.add("max_imu_strain", max_imu_strain,
             {"sigma", 0.01, 100, "IMU residuals of the window beyond which cameras are believed less"});
  fields.add("max_noise_scale", max_noise_scale, {"", 1, 100, "largest adapted noise over the configured one"});
  fields.add("sigma_inflation", sigma_inflation,
             {"", 0.1, 100, "reported standard deviations over those of the window; with events alone 1.4 times that"});
  fields.group("track_noise", track_noise);
  fields.group("calibration", calibration);
  fields.group("landmarks", landmarks);
  fields.group("standstill", standstill);
}

}  // namespace edged
