// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/light.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace edged {
namespace {

constexpr double kPanel_m = 0.3;
constexpr double kShininess = 60.0;  // exponent of the cosine to the mirrored ray
constexpr double kLobe = 0.85;       // least such cosine: below it there is a ten-thousandth of the light
constexpr double kSunWidth_rad = 0.0093;
// Spotlight: extent and speed of its motion; the edge of its cone, from full light to none.
constexpr double kYaw_rad = 0.5, kPitch_rad = 0.3, kYaw_hz = 0.23, kPitch_hz = 0.37;
constexpr float kFullCosine = 0.951F, kOuterCosine = 0.848F;  // 18 and 32 deg
constexpr float kPowerDistance_m = 2.0F;

double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

/// A light that is on at first, and is switched at these instants.
double switched_level(const std::vector<double>& switch_s, double t_s) {
  const auto next = std::upper_bound(switch_s.begin(), switch_s.end(), t_s);
  const auto count = next - switch_s.begin();
  if (count == 0) return 1.0;
  const double share = smooth((t_s - *(next - 1)) / kSwitching_s);
  return count % 2 == 0 ? share : 1.0 - share;
}

Lamp side_lamp(const Eigen::Vector3d& towards_wall, const Eigen::Vector3d& size, double duration_s, Random& random) {
  Lamp lamp;
  lamp.axis_W = -towards_wall;
  lamp.centre_W = 0.49 * size.cwiseProduct(towards_wall) + Eigen::Vector3d(0.0, 0.0, 1.9);
  lamp.power = 7.0;
  // With probability one half, the light is off at first.
  if (random.uniform() < 0.5) lamp.switch_s.push_back(-1.0);
  for (double t = random.uniform(2.0, 5.0); t < duration_s; t += random.uniform(1.0, 5.0)) lamp.switch_s.push_back(t);
  return lamp;
}

/// Low enough for its light to reach across the floor and the wall at +x.
SunWindow sun_window(const Eigen::Vector3d& size) {
  SunWindow sun;
  sun.centre_W = {-0.5, 0.5 * size.y(), 1.7};
  sun.u_W = Eigen::Vector3d::UnitX(), sun.v_W = Eigen::Vector3d::UnitZ();
  sun.half_u = 0.8, sun.half_v = 0.6;
  sun.direction_W = Eigen::Vector3d(0.55, -0.75, -0.36).normalized();
  sun.power = 12.0;
  return sun;
}

}  // namespace

std::optional<Lighting> make_lighting(LightingKind kind, const Eigen::Vector3d& size, double brightness,
                                      double duration_s, Random& random) {
  if (kind == LightingKind::Even) return std::nullopt;
  const bool weak = kind != LightingKind::Lamps;
  Lighting lighting;
  lighting.ambient = weak ? 0.15 : 0.35;
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d centre_W(side * 0.24 * size.x(), 0.0, size.z() - 0.03);
    lighting.lamps.push_back({centre_W, -Eigen::Vector3d::UnitZ(), weak ? 1.5 : 4.0, {}});
  }
  if (kind == LightingKind::Switched)
    for (const Eigen::Vector3d& wall :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0)})
      lighting.lamps.push_back(side_lamp(wall, size, duration_s, random));
  if (kind == LightingKind::Sun) lighting.sun = sun_window(size);
  lighting.ambient *= brightness;
  for (Lamp& lamp : lighting.lamps) lamp.power *= brightness;
  if (lighting.sun) lighting.sun->power *= brightness;
  return lighting;
}

double lamp_level(const Lamp& lamp, double t_s) { return switched_level(lamp.switch_s, t_s); }

double lamp_light(const Lamp& lamp, const Eigen::Vector3d& p_W, const Eigen::Vector3d& n_W) {
  const Eigen::Vector3d ray = p_W - lamp.centre_W;
  const double squared = std::max(ray.squaredNorm(), 1e-12);
  const double cosines = std::max(0.0, lamp.axis_W.dot(ray)) * std::max(0.0, -n_W.dot(ray)) / squared;
  return lamp.power * cosines / (squared + kPanel_m * kPanel_m);
}

double lamp_highlight(const Lamp& lamp, const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
  const Eigen::Vector3d ray = (p - lamp.centre_W).normalized();
  const double cosine = (ray - 2.0 * n.dot(ray) * n).dot(-p.normalized());
  if (cosine < kLobe) return 0.0;
  return 0.5 * (kShininess + 2.0) * std::pow(cosine, kShininess) * lamp_light(lamp, p, n);
}

Beam beam_at(const Spotlight& spot, double t_s) {
  const double yaw_w = 2.0 * std::numbers::pi * kYaw_hz, pitch_w = 2.0 * std::numbers::pi * kPitch_hz;
  const double yaw = kYaw_rad * std::sin(yaw_w * t_s + spot.phase_yaw);
  const double pitch = kPitch_rad * std::sin(pitch_w * t_s + spot.phase_pitch);
  const Eigen::Vector3d side = Eigen::Vector3d::UnitZ().cross(spot.axis_W).normalized();
  // It is switched on before begin_s, so that it has full light at begin_s.
  const double there = smooth((t_s - spot.begin_s) / kSwitching_s + 1.0) - smooth((t_s - spot.end_s) / kSwitching_s);
  const double level = there * switched_level(spot.switch_s, t_s);
  const double rate = kYaw_rad * yaw_w * std::abs(std::cos(yaw_w * t_s + spot.phase_yaw)) +
                      kPitch_rad * pitch_w * std::abs(std::cos(pitch_w * t_s + spot.phase_pitch));
  return {spot.centre_W,
          Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * (Eigen::AngleAxisd(pitch, side) * spot.axis_W),
          spot.power * level, level == 0.0 ? 0.0 : rate};
}

float beam_light(const Beam& beam, const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
  const Eigen::Vector3f ray = p - beam.centre.cast<float>();
  const float squared = std::max(ray.squaredNorm(), 1e-6F), distance = std::sqrt(squared);
  const float cosine = beam.axis.cast<float>().dot(ray) / distance;
  const float incidence = -n.dot(ray) / distance;
  if (cosine <= kOuterCosine || incidence <= 0.0F) return 0.0F;
  const float x = std::min(1.0F, (cosine - kOuterCosine) / (kFullCosine - kOuterCosine));
  return static_cast<float>(beam.power) * x * x * (3.0F - 2.0F * x) * incidence * kPowerDistance_m * kPowerDistance_m /
         squared;
}

double sun_light(const SunWindow& sun, const Eigen::Vector3d& p_W, const Eigen::Vector3d& n_W) {
  const double cosine = -n_W.dot(sun.direction_W);
  const Eigen::Vector3d normal_W = sun.u_W.cross(sun.v_W);
  const double distance = normal_W.dot(p_W - sun.centre_W) / normal_W.dot(sun.direction_W);
  if (cosine <= 0.0 || distance <= 0.0) return 0.0;
  const Eigen::Vector3d hole = p_W - distance * sun.direction_W - sun.centre_W;
  const double blur = std::max(0.01, kSunWidth_rad * distance);
  const double u = smooth(0.5 + (sun.half_u - std::abs(sun.u_W.dot(hole))) / blur);
  const double v = smooth(0.5 + (sun.half_v - std::abs(sun.v_W.dot(hole))) / blur);
  return sun.power * cosine * u * v;
}

}  // namespace edged
