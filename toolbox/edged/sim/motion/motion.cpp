// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/motion/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/sim/motion/flight.hpp"
#include "edged/sim/random.hpp"

namespace edged {
namespace {

/// A smooth random signal within [-1, 1]: three sines whose frequencies [Hz] have no common period.
class Sway {
 public:
  explicit Sway(Random& random) {
    for (std::size_t i = 0; i < 3; ++i) {
      frequency_[i] = kFrequencies[i] * random.uniform(0.85, 1.15);
      phase_[i] = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  double operator()(double t) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      sum += kAmplitudes[i] * std::sin(2.0 * std::numbers::pi * frequency_[i] * t + phase_[i]);
    return sum;
  }

 private:
  static constexpr std::array<double, 3> kFrequencies{0.13, 0.31, 0.67}, kAmplitudes{0.55, 0.30, 0.15};
  std::array<double, 3> frequency_{}, phase_{};
};

/// Three signals with different amplitudes. Their clock is scaled for the wanted peak of the combined speed.
class Sway3 {
 public:
  Sway3(const Eigen::Vector3d& reach, double peak_speed, double duration_s, Random& random)
      : reach_(reach), sways_{Sway(random), Sway(random), Sway(random)} {
    constexpr double kStep = 0.02;
    // The scale of the clock determines the part of the signals that is used, so their peak is computed again.
    for (int round = 0; round < 4; ++round) {
      double peak = 1e-9;
      for (double t = 0.0; t < duration_s; t += kStep)
        peak = std::max(peak, ((*this)(t + kStep) - (*this)(t)).norm() / kStep);
      pace_ *= peak_speed / peak;
    }
  }
  Eigen::Vector3d operator()(double t) const {
    const double s = pace_ * t;
    return reach_.cwiseProduct(Eigen::Vector3d(sways_[0](s), sways_[1](s), sways_[2](s)));
  }

 private:
  Eigen::Vector3d reach_;
  std::array<Sway, 3> sways_;
  double pace_ = 1.0;
};

Trajectory random_camera_poses(const MotionConfig& config, double duration_s, std::uint64_t seed) {
  constexpr double kRate = 100.0;
  Random random(seed, 1);
  const Sway3 position(config.extent_m * Eigen::Vector3d(1.0, 1.0, 0.5), config.max_speed, duration_s, random);
  const Sway3 angles(config.max_angle_deg * kDegree * Eigen::Vector3d(0.3, 0.5, 1.0), config.max_rate_deg_s * kDegree,
                     duration_s, random);
  Eigen::Matrix3d R_W_level;  // camera axes: x to the right (-y of W), y down, z along +x of W
  R_W_level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Trajectory poses;
  for (int i = 0; i <= static_cast<int>(std::ceil(duration_s * kRate)); ++i) {
    const double t = i / kRate;
    const Eigen::Vector3d a = angles(t);  // roll, pitch, yaw
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(a.z(), Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(a.y(), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(a.x(), Eigen::Vector3d::UnitX());
    const Eigen::Vector3d p = position(t) + Eigen::Vector3d(0.0, 0.0, 1.3);
    poses.push_back({timestamp_from_seconds(t), SE3(turn * Eigen::Quaterniond(R_W_level), p)});
  }
  return poses;
}

/// A hand holds the camera towards the target: tilted by where it is, with the target now here, now there in the image.
Trajectory poses_around_target(const MotionConfig& config, double duration_s, std::uint64_t seed) {
  constexpr double kRate = 100.0;
  Random random(seed, 1);
  const Sway3 position(Eigen::Vector3d(0.35 * config.target_m, config.extent_m, 0.8 * config.extent_m),
                       config.max_speed, duration_s, random);
  const Sway3 angles(kDegree * Eigen::Vector3d(config.aim_deg, 0.75 * config.aim_deg, config.max_angle_deg),
                     config.max_rate_deg_s * kDegree, duration_s, random);
  Trajectory poses;
  for (int i = 0; i <= static_cast<int>(std::ceil(duration_s * kRate)); ++i) {
    const double t = i / kRate;
    const Eigen::Vector3d from_target = position(t) - config.target_m * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d ahead = -from_target.normalized();
    const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d R_W_level;
    R_W_level << right, ahead.cross(right), ahead;
    const Eigen::Vector3d a = angles(t);  // to the side, up, roll
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(a.x(), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(a.y(), Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(a.z(), Eigen::Vector3d::UnitZ());
    poses.push_back({timestamp_from_seconds(t),
                     SE3(Eigen::Quaterniond(R_W_level) * turn, from_target + Eigen::Vector3d(0.0, 0.0, 1.3))});
  }
  return poses;
}

Trajectory recorded_poses(const MotionConfig& config, double duration_s) {
  const Trajectory all = read_tum(config.file);
  if (all.empty()) throw InputError::format("{}: no poses; give a TUM trajectory", config.file);
  const Timestamp begin = all.front().t + duration_from_seconds(config.start_s);
  const Timestamp end = begin + duration_from_seconds(duration_s);
  if (all.back().t < end)
    throw InputError::format(
        "{}: ends {:.3f} s after its first pose, but {:.3f} s are wanted; lower duration_s or "
        "motion.start_s",
        config.file, to_seconds(all.back().t - all.front().t), config.start_s + duration_s);
  Trajectory poses;
  for (const StampedPose& pose : all)
    if (pose.t >= begin && pose.t <= end) poses.push_back(pose);
  return poses;
}

}  // namespace

void MotionConfig::visit(ConfigFields& fields) {
  fields.add("file", file, {.effect = "TUM trajectory to follow; empty: random motion"});
  fields.choice("flight", flight,
                {{"none", Manoeuvre::None},
                 {"circle", Manoeuvre::Circle},
                 {"aggressive", Manoeuvre::Aggressive},
                 {"square", Manoeuvre::Square},
                 {"line", Manoeuvre::Line},
                 {"turned", Manoeuvre::Turned},
                 {"free", Manoeuvre::Free}},
                {.effect = "a quadrotor's flight from take-off to landing in place of random motion; without blend"});
  fields.add("start_s", start_s, {"s", 0, 1e6, "where in the file to start"});
  fields.choice("pose_of", pose_of, {{"camera", PoseOf::Camera}, {"body", PoseOf::Body}},
                {.effect = "whose pose the file holds"});
  fields.add("rest_s", rest_s, {"s", 0, 1e3, "time at rest before the motion"});
  fields.add("blend_s", blend_s, {"s", 0, 1e3, "time from rest to the full speed of the motion"});
  fields.add("knot_s", knot_s, {"s", 0.005, 1, "spacing of the spline's knots; larger is smoother"});
  fields.add("extent_m", extent_m, {"m", 0.01, 100, "random motion: reach to each side; upwards half of it"});
  fields.add("max_angle_deg", max_angle_deg,
             {"deg", 0.1, 180, "random motion: reach of yaw; pitch half, roll a third of it"});
  fields.add("max_speed", max_speed, {"m/s", 0.001, 50, "random motion: peak speed"});
  fields.add("max_rate_deg_s", max_rate_deg_s, {"deg/s", 0.1, 2000, "random motion: peak angular rate"});
  fields.add("target_m", target_m,
             {"m", 0, 30, "random motion around a target at this mean distance, the camera towards it; 0: none"});
  fields.add("aim_deg", aim_deg, {"deg", 0, 80, "around a target: how far it strays from the middle of the image"});
}

ContinuousTrajectory make_motion(const MotionConfig& config, double duration_s, const SE3& T_B_C, std::uint64_t seed) {
  if (config.flight != Manoeuvre::None)
    return {PoseSpline::fit(fly(config.flight, seed), {.knot_s = config.knot_s, .reweightings = 0}), config.rest_s,
            0.0};
  // The blend delays the clock by half its length. A small margin keeps the end of the spline after the recording.
  const double moving_s = std::max(1.0, duration_s - config.rest_s - 0.5 * config.blend_s + 0.1);
  const bool random = config.file.empty();
  Trajectory poses = !random                 ? recorded_poses(config, moving_s)
                     : config.target_m > 0.0 ? poses_around_target(config, moving_s, seed)
                                             : random_camera_poses(config, moving_s, seed);
  if (random || config.pose_of == PoseOf::Camera) {
    const SE3 T_C_B = T_B_C.inverse();
    for (StampedPose& pose : poses) pose.T = pose.T * T_C_B;
  }
  const SplineFit options{.knot_s = config.knot_s, .reweightings = random ? 0 : 5};
  return {PoseSpline::fit(poses, options), config.rest_s, config.blend_s};
}

}  // namespace edged
