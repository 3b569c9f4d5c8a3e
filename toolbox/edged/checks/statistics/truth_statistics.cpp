// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/truth_statistics.hpp"

#include <algorithm>
#include <vector>

#include "edged/core/path_length.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kNeighbours = 5;  // steps on either side
constexpr Duration kShortestFrozen = std::chrono::milliseconds(50);
// A jump exceeds so many times the median speed of its neighbours, and what so much acceleration gives in its time.
// (Motion capture reaches 10 and 17 times the median, rarely; wrong poses had at least 500 and 119.)
constexpr double kTimesSpeed = 20.0, kTimesRate = 40.0;
constexpr double kMostAcceleration = 100.0, kMostTurning = 1000.0;  // [m/s^2], [rad/s^2]
// A body stops less abruptly: a faster one was frozen.
constexpr double kMostBraking = 20.0, kMostTurnBraking = 50.0;  // [m/s^2], [rad/s^2]

struct TruthStep {
  Timestamp begin, end;
  double length_m, angle_rad;
  double speed, rate;  ///< [m/s], [rad/s]; as stamps jitter, at least the typical step counts

  bool none() const { return length_m == 0.0 && angle_rad == 0.0; }
};
using Steps = std::vector<TruthStep>;

Steps steps_of(const Trajectory& poses, Duration typical) {
  Steps steps;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const StampedPose &a = poses[i - 1], &b = poses[i];
    const double dt_s = to_seconds(std::max({b.t - a.t, typical, Duration(1)}));
    const double length_m = (b.T.translation() - a.T.translation()).norm();
    const bool same = a.T.rotation().coeffs() == b.T.rotation().coeffs();
    const double angle_rad = same ? 0.0 : so3::log(a.T.rotation().conjugate() * b.T.rotation()).norm();
    steps.push_back({a.t, b.t, length_m, angle_rad, length_m / dt_s, angle_rad / dt_s});
  }
  return steps;
}

bool is_jump(const Steps& steps, std::size_t i) {
  const TruthStep& step = steps[i];
  const double dt_s = to_seconds(step.end - step.begin);
  if (step.speed <= kMostAcceleration * dt_s && step.rate <= kMostTurning * dt_s) return false;
  std::vector<double> speeds, rates;
  for (std::size_t k = i - std::min(i, kNeighbours); k < std::min(steps.size(), i + kNeighbours + 1); ++k)
    speeds.push_back(steps[k].speed), rates.push_back(steps[k].rate);
  return step.speed > kTimesSpeed * median(std::move(speeds)) + kMostAcceleration * dt_s ||
         step.rate > kTimesRate * median(std::move(rates)) + kMostTurning * dt_s;
}

/// True if the mean motion of the steps before the i-th is faster than a body stops within one.
bool moves_before(const Steps& steps, std::size_t i, Duration typical) {
  if (i < kNeighbours) return false;
  double speed = 0.0, rate = 0.0;
  for (std::size_t k = i - kNeighbours; k < i; ++k)
    speed += steps[k].speed / kNeighbours, rate += steps[k].rate / kNeighbours;
  return speed > kMostBraking * to_seconds(typical) || rate > kMostTurnBraking * to_seconds(typical);
}

}  // namespace

TruthStatistics truth_statistics(const GroundTruth& truth) {
  TruthStatistics statistics;
  statistics.frame = truth.frame;
  StreamCollector stream;
  for (const StampedPose& pose : truth.trajectory) stream.add(pose.t, pose.t);
  statistics.path_m = path_length(truth.trajectory, &StampedPose::T);
  statistics.stream = stream.result();
  const Duration typical = statistics.stream.typical_step;
  const Steps steps = steps_of(truth.trajectory, typical);
  for (std::size_t i = 0, still = 0; i < steps.size(); ++i) {  // still: the first step of the same pose
    const bool jump = is_jump(steps, i);
    if (jump && statistics.jumps++ == 0) statistics.first_jump = {steps[i].end, steps[i].length_m, steps[i].angle_rad};
    if (steps[i].none() && i + 1 < steps.size()) continue;
    const Duration length = steps[i].begin - steps[still].begin;
    if (i - still >= kNeighbours && length >= std::max(kShortestFrozen, statistics.frozen) &&
        (jump || moves_before(steps, still, typical))) {
      statistics.frozen = length;
      statistics.frozen_since = steps[still].begin;
    }
    still = i + 1;
  }
  return statistics;
}

}  // namespace edged
