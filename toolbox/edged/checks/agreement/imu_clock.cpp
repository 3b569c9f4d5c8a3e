// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/imu_clock.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "edged/checks/agreement/gyro_agreement.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestClockTurns = 30, kMostClockTurns = 200;
constexpr double kLeastCorrelation = 0.9;
constexpr double kFarBetter = 0.4;   // ratio of the unexplained shares with the corrected and with the given clock
constexpr double kLeastOff = 0.004;  // relative error of the rate; smaller ones are not observable from rotations
constexpr double kDriftSearched = 0.06, kDriftStep = 0.003;
constexpr Duration kClockShiftStep = std::chrono::milliseconds(10);

/// Pearson correlation of the angular speeds of camera and gyro at a rate and a shift. 0 if both cover too few
/// rotations.
double correlation_at(std::span<const Turn> turns, const GyroIntegral& gyro, double rate, Duration shift) {
  const auto on_imu = [&](Timestamp t) {
    return gyro.first() + duration_from_seconds(rate * to_seconds(t + shift - gyro.first()));
  };
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  const std::size_t every = std::max<std::size_t>(1, turns.size() / kMostClockTurns);
  for (std::size_t i = 0; i < turns.size(); i += every) {
    const Timestamp begin = on_imu(turns[i].begin), end = on_imu(turns[i].end);
    const auto phi = gyro.between(begin, end);
    if (!phi || end <= begin) continue;
    const double a = turns[i].phi_C.norm() / to_seconds(turns[i].end - turns[i].begin);
    const double b = phi->norm() / to_seconds(end - begin);
    n += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
  }
  if (n < kFewestClockTurns) return 0.0;
  const double variance = (xx - x * x / n) * (yy - y * y / n);
  return variance > 0.0 ? (xy - x * y / n) / std::sqrt(variance) : 0.0;
}

/// The correlation at the best shift.
double correlation_at(std::span<const Turn> turns, const GyroIntegral& gyro, double rate, Duration expected,
                      Duration most) {
  double best = 0.0;
  for (Duration shift = expected - most; shift <= expected + most; shift += kClockShiftStep)
    best = std::max(best, correlation_at(turns, gyro, rate, shift));
  return best;
}

double unexplained(double correlation) { return 1.0 - correlation * correlation; }

}  // namespace

std::optional<ClockRate> other_clock_rate(std::span<const Turn> turns, const GyroIntegral& gyro, Duration expected,
                                          double spans) {
  if (turns.size() < kFewestClockTurns || gyro.empty()) return std::nullopt;
  std::vector<double> rates;
  for (const double about : {1.0, 2.0, 0.5, spans})
    for (double off = -kDriftSearched; off < kDriftSearched + kDriftStep / 2; off += kDriftStep)
      if (about > 0.1 && about < 10.0) rates.push_back(about * (1.0 + off));
  ClockRate best;
  for (const double rate : rates) {
    const double found = correlation_at(turns, gyro, rate, expected, 2 * kClockShiftStep);
    if (found > best.correlation) best = {rate, found};
  }
  const double given = correlation_at(turns, gyro, 1.0, expected, kMostShift);
  const bool better =
      best.correlation > kLeastCorrelation && unexplained(best.correlation) < kFarBetter * unexplained(given);
  return better && std::abs(best.rate - 1.0) > kLeastOff ? std::optional(best) : std::nullopt;
}

}  // namespace edged
