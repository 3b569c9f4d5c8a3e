// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options/estimator.hpp"

#include "edged/core/config/option_text.hpp"

namespace edged {

void HeightConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled, {.effect = "Use the samples of a height sensor."});
  fields.add("sigma_m", sigma_m, {"m", 1e-3, 100, "Standard deviation of samples without their own."});
  fields.add("bias_walk", bias_walk,
             {"m/sqrt(s)", 0, 10, "Random walk of the reference level (drift of a barometer)."});
}

void VelocityConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled, {.effect = "Use the samples of a velocity sensor."});
  fields.add("sigma_mps", sigma_mps, {"m/s", 1e-3, 100, "Standard deviation of samples without their own."});
  fields.add("scale_sigma", scale_sigma,
             {"", 0, 1, "Prior uncertainty of its scale, which is estimated, too. 0: the scale is taken as exact."});
  fields.add("position_m", position_m,
             {.unit = "m", .effect = "Position of the velocity sensor in the body frame: x y z."});
  fields.add("rotation_deg", rotation_deg,
             {.unit = "deg", .effect = "Orientation of its axes in the body frame: roll pitch yaw."});
}

SE3 VelocityConfig::T_B_S() const {
  return {rotation_of_degrees(rotation_deg, "velocity.rotation_deg"), three_numbers(position_m, "velocity.position_m")};
}

void CalibrationConfig::visit(ConfigFields& fields) {
  fields.add(
      "rotation_sigma_deg", rotation_sigma_deg,
      {"deg", 0, 10, "Prior uncertainty of each camera's rotation relative to the IMU. 0 keeps the given value."});
  fields.add("time_offset_sigma_ms", time_offset_sigma_ms,
             {"ms", 0, 50, "Prior uncertainty of each camera's time offset. 0 keeps the given value."});
  fields.add(
      "lever_arm_sigma_mm", lever_arm_sigma_mm,
      {"mm", 0, 500, "Prior uncertainty of each camera's position relative to the IMU. 0 keeps the given value."});
  fields.add("focal_sigma", focal_sigma,
             {"1", 0, 0.1, "Prior relative uncertainty of each camera's focal lengths. 0 keeps the given values."});
  fields.add("principal_point_sigma_px", principal_point_sigma_px,
             {"px", 0, 50, "Prior uncertainty of each camera's principal point. 0 keeps the given value."});
  fields.add("distortion_sigma", distortion_sigma,
             {"1", 0, 0.5,
              "Prior uncertainty of the first distortion coefficient of each camera; that of the second is as large at "
              "the rim of "
              "the image. 0 keeps the given values."});
  fields.add(
      "relative_rotation_sigma_deg", relative_rotation_sigma_deg,
      {"deg", 0.001, 10,
       "Prior uncertainty of the rotation between a camera and the first one of its kind, and between the first event "
       "camera and the first frame camera."});
  fields.add("baseline_sigma_mm", baseline_sigma_mm,
             {"mm", 0, 500,
              "Prior uncertainty of the position between them. 0: neither it nor the rotation is known beforehand."});
  fields.add("imu_sigma", imu_sigma,
             {"1", 0, 0.1,
              "Prior uncertainty of scale factors and axis misalignment of gyroscope and accelerometer. 0 keeps them "
              "as given."});
}

void TrackNoise::visit(ConfigFields& fields) {
  fields.add("correlation", correlation,
             {"1", 0, 0.999,
              "Correlation of the errors of two consecutive observations of a track in frames. 0: independent."});
  fields.add(
      "event_correlation", event_correlation,
      {"1", 0, 0.999,
       "Correlation in event frames. A higher value is more accurate in static scenes but rejects slow objects less."});
}

void EstimatorConfig::visit(ConfigFields& fields) {
  fields.add("recent_states", recent_states, {"", 1, 20, "Number of newest states in the window, keyframes or not."});
  fields.add("keyframes", keyframes,
             {"", 2, 30, "Number of older keyframes in the window. More are more accurate and slower."});
  fields.add("max_interval_s", max_interval_s,
             {"s", 0.2, 10, "A state becomes a keyframe after this time in any case."});
  fields.add("iterations", iterations, {"", 1, 50, "Solver iterations per packet."});
  fields.add(
      "init_scale_sigma", init_scale_sigma,
      {"", 0.01, 1, "A start in motion is Good once the relative standard deviation of the scale is below this."});
  fields.add("provisional_scale_sigma", provisional_scale_sigma,
             {"", 0.01, 1, "A start below this is used with status Degraded, and refined."});
  fields.add("noise_inflation", noise_inflation,
             {"", 0.5, 20, "Assumed noise relative to the spread of new residuals."});
  fields.add(
      "event_noise_inflation", event_noise_inflation,
      {"", 0.5, 20,
       "Further factor on the noise of event cameras used beside frame cameras, unless these are far less accurate."});
  fields.add(
      "sigma_inflation", sigma_inflation,
      {"", 0.1, 100, "Reported standard deviations relative to those of the window. Events alone: 1.4 times this."});
  fields.group("track_noise", track_noise);
  fields.group("calibration", calibration);
  fields.group("landmarks", landmarks);
  fields.group("standstill", standstill);
  fields.group("depth_factor", depth_factor);
}

}  // namespace edged
