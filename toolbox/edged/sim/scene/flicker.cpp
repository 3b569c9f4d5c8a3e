// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/flicker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace edged {
namespace {

constexpr int kKnots = 16;  // of a sine
// An LED takes microseconds to follow its current; so steep an edge in a hundredth of the cycle is no other for a
// pixel.
constexpr double kEdge = 0.01;

double wrapped(double cycles) { return cycles - std::floor(cycles); }

}  // namespace

void FlickerConfig::visit(ConfigFields& fields) {
  fields.choice("wave", wave, {{"mains", FlickerWave::Mains}, {"pwm", FlickerWave::Pwm}},
                {.effect = "of the light: the power of the rectified mains, or switched on and off"});
  fields.add("hz", hz, {"Hz", 10, 5000, "of the light: twice that of the mains"});
  fields.add("duty", duty, {"", 0.05, 0.95, "of pwm: share of the time with light"});
  fields.add("reach_m", reach_m,
             {"m", 0, 100, "of one lamp among others: where its share of the light is a half; 0: all flicker"});
}

/// The light over its mean, minus one.
double Flicker::wave(double cycles) const {
  const double modulation = disturbance_.strength;
  // Power is voltage squared, so that a resistive load on mains gives a sine with twice its frequency.
  if (config_.wave == FlickerWave::Mains) return modulation * std::sin(2.0 * std::numbers::pi * cycles);
  const double phase = wrapped(cycles);
  const double on = std::clamp(phase / kEdge, 0.0, 1.0) - std::clamp((phase - config_.duty) / kEdge, 0.0, 1.0);
  const double mean = 1.0 - modulation + 2.0 * modulation * config_.duty;
  return (1.0 - modulation + 2.0 * modulation * on) / mean - 1.0;
}

FlickerNow Flicker::at(double t_s, const SE3& T_C_W) const {
  FlickerNow now;
  if (!disturbance_.is(DisturbanceKind::Flicker, t_s)) return now;
  now.centre = (T_C_W * centre_W_).cast<float>();
  now.deviation = static_cast<float>(wave(t_s * config_.hz));
  now.reach = static_cast<float>(config_.reach_m);
  return now;
}

double Flicker::next_knot_s(double t_s) const {
  constexpr double kLong_s = 1.0, kRounding_s = 1e-6;  // of pictures to microseconds
  if (t_s >= disturbance_.end_s()) return t_s + kLong_s;
  const double cycles = (std::max(t_s, disturbance_.at_s) + kRounding_s) * config_.hz;
  if (config_.wave == FlickerWave::Mains) return (std::floor(cycles * kKnots) + 1.0) / (kKnots * config_.hz);
  const double begin = std::floor(cycles);
  for (const double knot : {0.0, kEdge, config_.duty, config_.duty + kEdge})
    if (begin + knot > cycles) return (begin + knot) / config_.hz;
  return (begin + 1.0) / config_.hz;
}

}  // namespace edged
