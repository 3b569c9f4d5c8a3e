// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/motion/flight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/sim/random.hpp"

namespace edged {
namespace {

constexpr double kGround_m = 0.25, kHeight_m = 1.3;
constexpr double kTakeOff_s = 2.5, kHover_s = 0.5, kLanding_s = 3.0, kStill_s = 1.0;
constexpr double kDrag = 0.25;  // deceleration by air of a level quadrotor per speed [1/s]

/// A step from 0 to 1 with three derivatives zero at both ends. Its steepest slope is 2.19.
double step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * x * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x)));
}

/// Time at full speed after u of duration_s seconds, with ramps of ramp_s at both ends.
double cruise(double u, double duration_s, double ramp_s) {
  const auto rise = [ramp_s](double t) {
    const double x = std::clamp(t / ramp_s, 0.0, 1.0);
    return ramp_s * x * x * x * x * (2.5 + x * (-3.0 + x)) + std::max(0.0, t - ramp_s);
  };
  return u < 0.5 * duration_s ? rise(u) : duration_s - ramp_s - rise(duration_s - u);
}

/// A manoeuvre on its own clock; heading in radians.
struct Path {
  double duration_s = 0.0;
  std::function<Eigen::Vector3d(double)> position;
  std::function<double(double)> heading;
};

constexpr double kRamp_s = 2.0;

Path circle() {
  constexpr double kRadius = 1.6, kRate = 1.1;
  const double duration = 6.0 * std::numbers::pi / kRate + kRamp_s;
  const auto angle = [=](double u) { return kRate * cruise(u, duration, kRamp_s); };
  return {
      duration,
      [=](double u) { return Eigen::Vector3d(kRadius * std::cos(angle(u)), kRadius * std::sin(angle(u)), kHeight_m); },
      [=](double u) { return angle(u) + 0.5 * std::numbers::pi; }};
}

Path aggressive() {
  constexpr double kDuration = 22.0;
  const auto clock = [](double u) { return cruise(u, kDuration, kRamp_s); };
  return {kDuration,
          [=](double u) {
            const double s = clock(u);
            return Eigen::Vector3d(0.7 * std::sin(1.13 * s) - 0.4, 1.15 * std::sin(1.9 * s) + 0.35 * std::sin(3.1 * s),
                                   kHeight_m + 0.3 * std::sin(0.83 * s));
          },
          [=](double u) { return 35.0 * kDegree * std::sin(0.6 * clock(u)); }};
}

Path square() {
  constexpr double kHalf = 1.4, kLeg_s = 2.5, kCorner_s = 0.9, kPeriod_s = kLeg_s + kCorner_s;
  constexpr double kEarly_s = 0.5;  // the turn begins before the corner and ends after it
  constexpr int kLegs = 8;
  static constexpr std::array<std::array<double, 2>, 4> kCorners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  return {kLegs * kPeriod_s - kCorner_s,
          [](double u) {
            const int leg = std::clamp(static_cast<int>(u / kPeriod_s), 0, kLegs - 1);
            const double share = step((u - leg * kPeriod_s) / kLeg_s);
            const auto &a = kCorners[static_cast<std::size_t>(leg % 4)],
                       &b = kCorners[static_cast<std::size_t>((leg + 1) % 4)];
            return Eigen::Vector3d(kHalf * (a[0] + share * (b[0] - a[0])), kHalf * (a[1] + share * (b[1] - a[1])),
                                   kHeight_m);
          },
          [](double u) {
            double quarters = 0.0;
            for (int leg = 0; leg + 1 < kLegs; ++leg)
              quarters += step((u - leg * kPeriod_s - kLeg_s + kEarly_s) / (kCorner_s + 2.0 * kEarly_s));
            return 0.5 * std::numbers::pi * quarters;
          }};
}

Path line() {
  constexpr double kFrom = -2.0, kTo = 1.8, kLeg_s = 3.8, kPeriod_s = kLeg_s + 0.4;
  constexpr int kLegs = 5;
  return {kLegs * kPeriod_s,
          [](double u) {
            double to_and_fro = 0.0;
            for (int leg = 0; leg < kLegs; ++leg)
              to_and_fro += (leg % 2 == 0 ? 1.0 : -1.0) * step((u - leg * kPeriod_s) / kLeg_s);
            return Eigen::Vector3d(kFrom + to_and_fro * (kTo - kFrom), 0.0, kHeight_m);
          },
          [](double) { return 0.0; }};
}

Path turned() {
  constexpr std::array<double, 7> kHeadings{0.0, 150.0, -60.0, 170.0, -120.0, 100.0, 0.0};  // [deg]
  constexpr double kPeakRate = 160.0, kPause_s = 0.3;                                       // [deg/s]
  const auto turn_s = [=](std::size_t i) { return 2.1875 * std::abs(kHeadings[i + 1] - kHeadings[i]) / kPeakRate; };
  double duration = 0.0;
  for (std::size_t i = 0; i + 1 < kHeadings.size(); ++i) duration += turn_s(i) + kPause_s;
  return {duration,
          [=](double u) {
            const double s = cruise(u, duration, kRamp_s);
            return Eigen::Vector3d(1.2 * std::sin(0.7 * s), 1.1 * std::sin(0.9 * s), kHeight_m);
          },
          [=](double u) {
            double heading = 0.0, begin = 0.0;
            for (std::size_t i = 0; i + 1 < kHeadings.size(); begin += turn_s(i) + kPause_s, ++i)
              heading += (kHeadings[i + 1] - kHeadings[i]) * step((u - begin) / turn_s(i));
            return heading * kDegree;
          }};
}

Path free_loops() {
  constexpr double kDuration = 22.0;
  const auto clock = [](double u) { return cruise(u, kDuration, kRamp_s); };
  return {kDuration,
          [=](double u) {
            const double s = clock(u);
            return Eigen::Vector3d(1.5 * std::sin(0.8 * s), 1.3 * std::sin(1.13 * s),
                                   kHeight_m + 0.25 * std::sin(0.6 * s));
          },
          [=](double u) { return 70.0 * kDegree * std::sin(0.5 * clock(u)); }};
}

Path hover() {
  return {22.0, [](double) { return Eigen::Vector3d(0.0, 0.0, kHeight_m); }, [](double) { return 0.0; }};
}

Path path_of(Manoeuvre manoeuvre) {
  switch (manoeuvre) {
    case Manoeuvre::Circle:
      return circle();
    case Manoeuvre::Aggressive:
      return aggressive();
    case Manoeuvre::Square:
      return square();
    case Manoeuvre::Line:
      return line();
    case Manoeuvre::Turned:
      return turned();
    case Manoeuvre::Free:
      return free_loops();
    case Manoeuvre::Hover:
      return hover();
    case Manoeuvre::None:
      break;
  }
  EDGED_CHECK(false, "manoeuvre {} has no path", static_cast<int>(manoeuvre));
}

/// From take-off to touch-down [s].
double airborne_s(const Path& path) { return kTakeOff_s + kHover_s + path.duration_s + kHover_s + kLanding_s; }

/// The effect of gusts and controller: per axis two sines of random phase, within [-1, 1].
class Wobble {
 public:
  Wobble(double slow_hz, double fast_hz, Random& random) {
    for (Axis& axis : axes_) {
      axis.slow = 2.0 * std::numbers::pi * slow_hz * random.uniform(0.8, 1.2);
      axis.fast = 2.0 * std::numbers::pi * fast_hz * random.uniform(0.8, 1.2);
      axis.slow_phase = random.uniform(0.0, 2.0 * std::numbers::pi);
      axis.fast_phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  Eigen::Vector3d operator()(double t) const {
    Eigen::Vector3d sum;
    for (std::size_t i = 0; i < 3; ++i) {
      const Axis& axis = axes_[i];
      sum[static_cast<Eigen::Index>(i)] =
          0.7 * std::sin(axis.slow * t + axis.slow_phase) + 0.3 * std::sin(axis.fast * t + axis.fast_phase);
    }
    return sum;
  }

 private:
  struct Axis {
    double slow, fast, slow_phase, fast_phase;
  };
  std::array<Axis, 3> axes_{};
};

/// The whole flight as functions of the time since take-off.
class Drone {
 public:
  Drone(Manoeuvre manoeuvre, std::uint64_t seed, double wind) : Drone(manoeuvre, Random(seed, 7), wind) {}

  double end_s() const { return airborne_s(path_) + kStill_s; }

  SE3 pose(double t) const {
    constexpr double h = 1e-3;
    const Eigen::Vector3d before = position(t - h), p = position(t), after = position(t + h);
    const Eigen::Vector3d v = (after - before) / (2.0 * h), a = (after - 2.0 * p + before) / (h * h);
    // Thrust is along z of the body and equals weight, acceleration and drag.
    const Eigen::Vector3d z = (a + kDrag * v - kGravity_W).normalized();
    const double heading = path_.heading(manoeuvre_time(t));
    const Eigen::Vector3d forward(std::cos(heading), std::sin(heading), 0.0);
    Eigen::Matrix3d R;
    R.col(2) = z;
    R.col(1) = z.cross(forward).normalized();
    R.col(0) = R.col(1).cross(z);
    const Eigen::Vector3d shake = 1.2 * kDegree * wind_ * aloft(t) * attitude_wobble_(t);
    return {Eigen::Quaterniond(R) * so3::exp(shake), p};
  }

 private:
  Drone(Manoeuvre manoeuvre, Random random, double wind)
      : path_(path_of(manoeuvre)),
        wind_(wind),
        position_wobble_(0.35, 0.9, random),
        attitude_wobble_(0.9, 3.1, random) {}

  double manoeuvre_time(double t) const { return std::clamp(t - kTakeOff_s - kHover_s, 0.0, path_.duration_s); }

  /// 0 on the ground, 1 in the air.
  double aloft(double t) const { return step(t / kTakeOff_s) * step((airborne_s(path_) - t) / kLanding_s); }

  Eigen::Vector3d position(double t) const {
    Eigen::Vector3d p = path_.position(manoeuvre_time(t));
    p.z() = kGround_m + aloft(t) * (p.z() - kGround_m);
    return p + 0.025 * wind_ * aloft(t) * position_wobble_(t);
  }

  Path path_;
  double wind_;
  Wobble position_wobble_, attitude_wobble_;
};

}  // namespace

Trajectory fly(Manoeuvre manoeuvre, std::uint64_t seed, double wind) {
  constexpr double kRate = 100.0;
  const Drone drone(manoeuvre, seed, wind);
  Trajectory poses;
  for (int i = 0; i <= static_cast<int>(std::ceil(drone.end_s() * kRate)); ++i)
    poses.push_back({timestamp_from_seconds(i / kRate), drone.pose(i / kRate)});
  return poses;
}

}  // namespace edged
