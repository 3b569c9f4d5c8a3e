// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/allan_deviation.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestClusterPairs = 8;  // the variance is then known to about a third
constexpr int kNoiseParts = 3;                  // white noise, instability, walk
using Parts = Eigen::Matrix<double, kNoiseParts, 1>;

struct AllanFit {
  Parts parts = Parts::Zero(), sigmas = Parts::Zero();
  double cost = std::numeric_limits<double>::infinity();
};

/// Least squares with those parts whose bit is set, relative to the points; nothing where one is negative.
std::optional<AllanFit> fit_with(unsigned chosen, std::span<const AllanDeviation::Point> points) {
  Eigen::Matrix<double, kNoiseParts, kNoiseParts> H = Eigen::Matrix<double, kNoiseParts, kNoiseParts>::Zero();
  Parts b = Parts::Zero();
  double cost = 0.0;
  for (const AllanDeviation::Point& point : points) {
    const double weight = std::sqrt(static_cast<double>(point.pairs)) / (point.deviation * point.deviation);
    Parts row = weight * Parts(1.0 / point.tau_s, 1.0, point.tau_s);
    for (int i = 0; i < kNoiseParts; ++i)
      if ((chosen >> static_cast<unsigned>(i) & 1U) == 0) row[i] = 0.0;
    const double wanted = std::sqrt(static_cast<double>(point.pairs));
    H += row * row.transpose();
    b += row * wanted;
    cost += wanted * wanted;
  }
  for (int i = 0; i < kNoiseParts; ++i)
    if ((chosen >> static_cast<unsigned>(i) & 1U) == 0) H(i, i) = 1.0;
  const Eigen::Matrix<double, kNoiseParts, kNoiseParts> P = H.inverse();
  AllanFit fit{P * b, P.diagonal().cwiseSqrt(), 0.0};
  fit.cost = cost - b.dot(fit.parts);
  return fit.parts.allFinite() && fit.parts.minCoeff() >= 0.0 ? std::optional(fit) : std::nullopt;
}

}  // namespace

void AllanDeviation::add(std::size_t level, double mean) {
  if (level == levels_.size()) levels_.emplace_back();
  Level& here = levels_[level];
  if (here.before) {
    here.sum += (mean - *here.before) * (mean - *here.before);
    ++here.pairs;
  }
  here.before = mean;
  if (!here.half) {
    here.half = mean;
    return;
  }
  const double whole = 0.5 * (*here.half + mean);
  here.half.reset();
  add(level + 1, whole);
}

void AllanDeviation::skip_gap() {
  for (Level& level : levels_) level.before.reset(), level.half.reset();
}

std::vector<AllanDeviation::Point> AllanDeviation::points() const {
  std::vector<Point> points;
  double tau_s = period_s_;
  for (const Level& level : levels_) {
    if (level.pairs >= kFewestClusterPairs && level.sum > 0.0)
      points.push_back({tau_s, std::sqrt(level.sum / (2.0 * static_cast<double>(level.pairs))), level.pairs});
    tau_s *= 2.0;
  }
  return points;
}

SignalNoise fit_noise(std::span<const AllanDeviation::Point> points) {
  EDGED_CHECK(points.size() >= kNoiseParts, "{} points", points.size());
  AllanFit best;
  for (unsigned chosen = 1; chosen < 1U << kNoiseParts; ++chosen) {
    const std::optional<AllanFit> fit = fit_with(chosen, points);
    if (fit && fit->cost < best.cost) best = *fit;
  }
  SignalNoise noise;
  noise.white = std::sqrt(best.parts[0]);
  noise.instability = std::sqrt(best.parts[1] * std::numbers::pi / (2.0 * std::numbers::ln2));
  noise.walk = std::sqrt(3.0 * best.parts[2]);
  // Of the part, where the walk is none: what would be seen.
  const double sigma = best.parts[2] > 0.0 ? best.sigmas[2] : fit_with(7U, points).value_or(best).sigmas[2];
  noise.walk_sigma = noise.walk > 0.0 ? 1.5 * sigma / noise.walk : std::sqrt(3.0 * sigma);
  return noise;
}

}  // namespace edged
