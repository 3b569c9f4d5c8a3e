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

constexpr double kHand_m = 0.2;  // from the wrist to the camera: a tremor of 1 mm turns it by 5 mrad
// Poses and knots for a tremor, which the usual ones would smooth away.
constexpr double kTremorRate_hz = 400.0, kTremorKnot_s = 0.01;

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

/// The clock of motion that pauses again and again: seconds in motion until t. The first pause comes after go_s.
class StopAndGo {
 public:
  StopAndGo(double go_s, double pause_s) : go_s_(go_s), pause_s_(pause_s), blend_s_(std::min({0.4, go_s, pause_s})) {}

  double operator()(double t) const {
    if (pause_s_ <= 0.0) return t;
    const double period_s = go_s_ + pause_s_, into_s = std::fmod(t, period_s);
    const auto moved = [this](double s) { return ramp(s, blend_s_).integral_s - ramp(s - go_s_, blend_s_).integral_s; };
    // It slows down after go_s, and the next period begins at rest.
    return std::floor(t / period_s) * moved(period_s) + moved(into_s);
  }

 private:
  double go_s_, pause_s_, blend_s_;
};

/// The tremor of a hand (4 to 12 Hz), of unit rms on each axis of position and rotation.
class Tremor {
 public:
  explicit Tremor(Random random) {
    for (auto& axis : axes_) {
      for (Sine& sine : axis) {
        sine.omega = 2.0 * std::numbers::pi * random.uniform(4.0, 12.0);
        sine.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
      }
    }
  }
  Vector6d operator()(double t) const {
    Vector6d sum = Vector6d::Zero();
    const double amplitude = std::sqrt(2.0 / static_cast<double>(axes_[0].size()));
    for (std::size_t i = 0; i < axes_.size(); ++i)
      for (const Sine& sine : axes_[i])
        sum[static_cast<Eigen::Index>(i)] += amplitude * std::sin(sine.omega * t + sine.phase);
    return sum;
  }

 private:
  struct Sine {
    double omega, phase;
  };
  std::array<std::array<Sine, 4>, 6> axes_{};
};

Eigen::Vector3d reach_of(MotionStyle style) {
  switch (style) {
    case MotionStyle::Approach:
      return {1.0, 0.05, 0.05};
    case MotionStyle::Altitude:
      return {0.05, 0.05, 1.0};
    case MotionStyle::Free:
    case MotionStyle::Pan:
      break;
  }
  return {1.0, 1.0, 0.5};
}

Trajectory random_camera_poses(const MotionConfig& config, double duration_s, std::uint64_t seed) {
  Random random(seed, 1);
  const bool pans = config.style == MotionStyle::Pan;
  const Sway3 position(config.extent_m * reach_of(config.style), config.max_speed, duration_s, random);
  const Sway3 angles(config.max_angle_deg * kDegree * Eigen::Vector3d(pans ? 0.0 : 0.3, 0.5, 1.0),
                     config.max_rate_deg_s * kDegree, duration_s, random);
  const StopAndGo clock(config.go_s, config.pause_s);
  const Tremor tremor(Random(seed, 13));
  Eigen::Matrix3d R_W_level;  // camera axes: x to the right (-y of W), y down, z along +x of W
  R_W_level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const double rate_hz = config.tremor_mm > 0.0 ? kTremorRate_hz : 100.0;
  Trajectory poses;
  for (int i = 0; i <= static_cast<int>(std::ceil(duration_s * rate_hz)); ++i) {
    const double stamp_s = i / rate_hz, t = clock(stamp_s);
    const Eigen::Vector3d a = angles(t);  // roll, pitch, yaw
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(a.z(), Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(a.y(), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(a.x(), Eigen::Vector3d::UnitX());
    const Eigen::Vector3d from_middle = pans ? turn * (config.lever_m * Eigen::Vector3d::UnitX()) : position(t);
    SE3 T_W_C(turn * Eigen::Quaterniond(R_W_level), from_middle + Eigen::Vector3d(0.0, 0.0, 1.3));
    if (config.tremor_mm > 0.0) {
      const Vector6d shake = 1e-3 * config.tremor_mm * tremor(stamp_s);
      T_W_C = T_W_C * SE3(so3::exp(shake.tail<3>() / kHand_m), shake.head<3>());
    }
    poses.push_back({timestamp_from_seconds(stamp_s), T_W_C});
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
        "{}: ends {:.3f} s after its first pose, but {:.3f} s are needed; lower duration_s or motion.start_s",
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
                 {"free", Manoeuvre::Free},
                 {"hover", Manoeuvre::Hover}},
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
  fields.choice(
      "style", style,
      {{"free", MotionStyle::Free},
       {"approach", MotionStyle::Approach},
       {"altitude", MotionStyle::Altitude},
       {"pan", MotionStyle::Pan}},
      {.effect = "random motion to all sides, to and from what is in view, up and down, or turning on a tripod"});
  fields.add("lever_m", lever_m, {"m", -1, 1, "of a pan: distance of the camera before the axes about which it turns"});
  fields.add("pause_s", pause_s, {"s", 0, 1e3, "random motion: it stops for so long from time to time; 0: never"});
  fields.add("go_s", go_s, {"s", 0.1, 1e3, "random motion: time from the end of a pause to the next"});
  fields.add(
      "tremor_mm", tremor_mm,
      {"mm", 0, 20, "random motion: rms of a hand's tremor of 4 to 12 Hz, which turns by 5 mrad a mm; not at rest"});
  fields.add("wind", wind, {"", 0, 20, "of a flight: gusts that push by 2.5 cm and turn by 1.2 deg at 1"});
  fields.add("target_m", target_m,
             {"m", 0, 30, "random motion around a target at this mean distance, the camera towards it; 0: none"});
  fields.add("aim_deg", aim_deg, {"deg", 0, 80, "around a target: how far it strays from the middle of the image"});
}

ContinuousTrajectory make_motion(const MotionConfig& config, double duration_s, const SE3& T_B_C, std::uint64_t seed) {
  if (config.flight != Manoeuvre::None)
    return {PoseSpline::fit(fly(config.flight, seed, config.wind), {.knot_s = config.knot_s, .reweightings = 0}),
            config.rest_s, 0.0};
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
  const bool trembles = random && config.target_m == 0.0 && config.tremor_mm > 0.0;
  const SplineFit options{.knot_s = trembles ? std::min(config.knot_s, kTremorKnot_s) : config.knot_s,
                          .reweightings = random ? 0 : 5};
  return {PoseSpline::fit(poses, options), config.rest_s, config.blend_s};
}

}  // namespace edged
