// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "edged/core/angles.hpp"
#include "edged/sim/scene/light.hpp"

namespace edged {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCovering_s = 0.06;
constexpr double kStopping_s = 0.5, kTurningRound_s = 1.5;
constexpr double kShake_hz = 4.0;
// Knocks: a vibration of 33 Hz that ends after a tenth of a second and slightly rotates the body.
constexpr double kRing_hz = 33.0, kDecay_s = 0.022, kRing_s = 0.1, kBlow_s = 0.006, kKnockTurn_rad = 0.004;
constexpr double kLowering_s = 0.5;

constexpr double kToTheEnd = -1.0;

/// A kind of disturbance and its usual length and strength, in the order of DisturbanceKind.
struct KindRow {
  std::string_view name;
  DisturbanceKind kind;
  double length_s = 0.0, strength = 0.0;
};

constexpr KindRow kKinds[] = {
    {"none", DisturbanceKind::None},
    {"lens-covered", DisturbanceKind::LensCovered, 2.0},
    {"lights-off", DisturbanceKind::LightsOff, 2.0, 0.03},  // share of the light that is left
    {"frames-missing", DisturbanceKind::FramesMissing, 5.0},
    {"events-missing", DisturbanceKind::EventsMissing, 1.0},
    {"imu-gap", DisturbanceKind::ImuGap, 0.3},
    {"gyro-saturation", DisturbanceKind::GyroSaturation, 1.0, 1.5},  // peak rate relative to the range of the gyro
    {"shake", DisturbanceKind::Shake, 1.0, 400.0},                   // peak rate [deg/s]
    {"person", DisturbanceKind::Person, 2.5},
    {"walkers", DisturbanceKind::Walkers, kToTheEnd, 0.4},               // share of the view
    {"wandering-lamp", DisturbanceKind::WanderingLamp, kToTheEnd, 7.5},  // relative to a well lit room
    {"switching-lamp", DisturbanceKind::SwitchingLamp, kToTheEnd, 7.5},
    {"blank-wall", DisturbanceKind::BlankWall, 4.0},
    {"pure-rotation", DisturbanceKind::PureRotation, 5.0},
    {"standstill", DisturbanceKind::Standstill, 60.0},
    {"put-down", DisturbanceKind::PutDown, 10.0, 2.0},        // peak of the knocks [g]
    {"event-storm", DisturbanceKind::EventStorm, 0.3, 20.0},  // million events a second
    {"flicker", DisturbanceKind::Flicker, kToTheEnd, 0.25}};  // modulation

/// A function of time with two derivatives [1/s, 1/s^2].
struct Jet {
  double value = 0.0, rate = 0.0, change = 0.0;

  Jet operator+(const Jet& b) const { return {value + b.value, rate + b.rate, change + b.change}; }
  Jet operator*(const Jet& b) const {
    return {value * b.value, rate * b.value + value * b.rate,
            change * b.value + 2.0 * rate * b.rate + value * b.change};
  }
  Jet operator*(double s) const { return {value * s, rate * s, change * s}; }
};

Jet to_jet(const Ramp& ramp, double t, double length_s) {
  const double x = t / length_s;
  const bool within = x > 0.0 && x < 1.0;
  return {ramp.value, ramp.slope, within ? 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (length_s * length_s) : 0.0};
}

/// Decaying vibration after t = 0, as of a light body after a hard contact. A sine of phase 0 at t = 0.
Jet ring(double t) {
  if (t <= 0.0 || t >= kRing_s) return {};
  constexpr double kOmega = 2.0 * kPi * kRing_hz;
  const double e = std::exp(-t / kDecay_s), s = std::sin(kOmega * t), c = std::cos(kOmega * t);
  const Jet decay{e, -e / kDecay_s, e / (kDecay_s * kDecay_s)};
  const Jet sine{s, kOmega * c, -kOmega * kOmega * s};
  const Jet fading = to_jet(ramp(t - 0.5 * kRing_s, 0.5 * kRing_s), t - 0.5 * kRing_s, 0.5 * kRing_s) * -1.0;
  return decay * sine * (Jet{1.0} + fading);
}

/// Vibration of a body that was at rest before, and is accelerated within a few milliseconds.
Jet hit(double t) { return ring(t) * to_jet(ramp(t, kBlow_s), t, kBlow_s); }

/// Largest second derivative.
double peak_change(Jet (*jet)(double)) {
  double peak = 0.0;
  for (double t = 0.0; t < kRing_s; t += 1e-4) peak = std::max(peak, std::abs(jet(t).change));
  return peak;
}

/// From 0 up to 1 after begin_s, and down again after end_s.
Ramp plateau(double t, double begin_s, double end_s, double ramp_s) {
  const Ramp up = ramp(t - begin_s, ramp_s), down = ramp(t - end_s, ramp_s);
  return {up.value - down.value, up.slope - down.slope, up.integral_s - down.integral_s};
}

}  // namespace

void Disturbance::visit(ConfigFields& fields) {
  std::vector<std::pair<std::string_view, DisturbanceKind>> kinds;
  for (const KindRow& row : kKinds) kinds.emplace_back(row.name, row.kind);
  fields.choice("kind", kind, kinds, {.effect = "what goes wrong in the recording"});
  fields.add("at_s", at_s, {"s", 0, 3600, "when it begins, on the camera's clock"});
  fields.add("length_s", length_s, {"s", 0, 3600, "how long it lasts; 0: the default of its kind"});
  fields.add(
      "strength", strength,
      {"", 0, 1e4,
       "0: the default of its kind. lights-off: share of the light left; gyro-saturation: peak rate over the gyro's "
       "range; "
       "shake: peak rate in deg/s; event-storm: million events a second; walkers: share of the view; lamps: their "
       "light over that of a well lit room; put-down: peak of the knocks in g; flicker: its modulation, from 0.05 to "
       "1, of which flicker.* has the rest"});
}

Disturbance Disturbance::filled_in(double recording_s) const {
  const KindRow& usual = kKinds[static_cast<std::size_t>(kind)];
  Disturbance filled = *this;
  if (length_s == 0.0) filled.length_s = usual.length_s;
  if (filled.length_s == kToTheEnd) filled.length_s = std::max(0.0, recording_s - at_s);
  if (strength == 0.0) filled.strength = usual.strength;
  return filled;
}

double Disturbance::light(double t_s) const {
  if (kind == DisturbanceKind::LensCovered) return 1.0 - plateau(t_s, at_s, end_s(), kCovering_s).value;
  if (kind == DisturbanceKind::LightsOff)
    return 1.0 - (1.0 - strength) * plateau(t_s, at_s, end_s(), kSwitching_s).value;
  return 1.0;
}

Kinematics DisturbedTrajectory::at(double t) const {
  Kinematics k = on_stopped_clock(t);
  const Turn extra = turn(t);
  if (disturbance_.kind == DisturbanceKind::PutDown) knock(t, k);
  if (extra.angle == 0.0 && extra.rate == 0.0) return k;
  const Eigen::Quaterniond R = so3::exp(extra.angle * axis_B_);
  k.T_W_B = SE3(k.T_W_B.rotation() * R, k.T_W_B.translation());
  k.omega_B = R.conjugate() * k.omega_B + extra.rate * axis_B_;
  return k;
}

Kinematics DisturbedTrajectory::on_stopped_clock(double t) const {
  const Kinematics moving = trajectory_.at(t);
  const bool rotates = disturbance_.kind == DisturbanceKind::PureRotation;
  const bool stands = disturbance_.kind == DisturbanceKind::Standstill || disturbance_.kind == DisturbanceKind::PutDown;
  if (!rotates && !stands) return moving;
  // The clock of the path is t minus the time for which the path was stopped.
  const Ramp still = plateau(t, disturbance_.at_s - kStopping_s, disturbance_.end_s(), kStopping_s);
  const double rate = 1.0 - still.value;
  Kinematics k = trajectory_.at(t - still.integral_s);
  k.a_W = k.a_W * rate * rate - k.v_W * still.slope;
  k.v_W *= rate;
  k.omega_B *= rate;
  if (rotates) {
    k.T_W_B = SE3(moving.T_W_B.rotation(), k.T_W_B.translation());
    k.omega_B = moving.omega_B;
  }
  return k;
}

void DisturbedTrajectory::knock(double t, Kinematics& k) const {
  const Disturbance& d = disturbance_;
  const double peak = d.strength * kStandardGravity;
  // The body is lowered at the speed that gives the required peak of the vibration at the contact. It is lifted with a
  // knock.
  static const double ring_peak = peak_change(ring), hit_peak = peak_change(hit);
  constexpr double kOmega = 2.0 * kPi * kRing_hz;
  const double reach_m = peak / ring_peak, speed = reach_m * kOmega;
  const Ramp sinking = ramp(t - (d.at_s - kLowering_s), kLowering_s);
  Jet height = ring(t - d.at_s) * -reach_m + hit(t - d.end_s()) * (peak / hit_peak);
  if (t < d.at_s) height = height + Jet{-speed * sinking.integral_s, -speed * sinking.value, -speed * sinking.slope};
  if (t >= d.at_s) {
    const double depth_m = speed * ramp(kLowering_s, kLowering_s).integral_s, since_s = t - d.end_s();
    height = height + (Jet{1.0} + to_jet(ramp(since_s, kLowering_s), since_s, kLowering_s) * -1.0) * -depth_m;
  }
  k.T_W_B = SE3(k.T_W_B.rotation(), k.T_W_B.translation() + height.value * Eigen::Vector3d::UnitZ());
  k.v_W.z() += height.rate;
  k.a_W.z() += height.change;
}

DisturbedTrajectory::Turn DisturbedTrajectory::turn(double t) const {
  const Disturbance& d = disturbance_;
  if (d.kind == DisturbanceKind::BlankWall) {
    const Ramp turned = plateau(t, d.at_s - kTurningRound_s, d.end_s(), kTurningRound_s);
    return {kPi * turned.value, kPi * turned.slope};
  }
  if (d.kind == DisturbanceKind::PutDown) {
    const Jet ring = hit(t - d.at_s) + hit(t - d.end_s());
    return {kKnockTurn_rad * d.strength * ring.value, kKnockTurn_rad * d.strength * ring.rate};
  }
  const double x = (t - d.at_s) / d.length_s;
  if (x <= 0.0 || x >= 1.0) return {};
  // sin^2 and its slope are 0 at both ends.
  const double swell = std::pow(std::sin(kPi * x), 2), swell_rate = kPi / d.length_s * std::sin(2.0 * kPi * x);
  if (d.kind == DisturbanceKind::GyroSaturation) {
    const double angle = d.strength * gyro_range_ * d.length_s / kPi;
    return {angle * swell, angle * swell_rate};
  }
  if (d.kind == DisturbanceKind::Shake) {
    const double omega = 2.0 * kPi * kShake_hz, angle = d.strength * kPi / 180.0 / omega;
    const double s = std::sin(omega * (t - d.at_s)), c = std::cos(omega * (t - d.at_s));
    return {angle * swell * s, angle * (swell_rate * s + swell * omega * c)};
  }
  return {};
}

}  // namespace edged
