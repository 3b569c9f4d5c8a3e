// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/eval/alignment.hpp"

namespace edged {
namespace {

constexpr double kMost_s = 0.5, kCoarse_s = 0.02;  // within a step, motion is nearly steady
constexpr std::size_t kMostPoses = 2000;
constexpr double kTold = 0.3;  // of the error of the whole: with less a piece tells nothing of an offset

/// The ATE with that offset, infinite where too few of the poses that have a truth without it still do.
class Errors {
 public:
  Errors(const Trajectory& truth, const Trajectory& estimate, Duration max_gap) : truth_(truth), max_gap_(max_gap) {
    const bool thin = typical_step(truth) <= typical_step(estimate);
    const std::size_t stride = thin ? estimate.size() / kMostPoses + 1 : 1;
    for (std::size_t i = 0; i < estimate.size(); i += stride) estimate_.push_back(estimate[i]);
    const auto pairs = static_cast<double>(pairs_at(0.0).size());
    fewest_ = static_cast<std::size_t>(kFewest * pairs);
    if (pairs > 0) compared_s_ = pairs * to_seconds(std::max(typical_step(truth), typical_step(estimate_)));
  }

  /// Time in which both have poses.
  double compared_s() const { return compared_s_; }

  double operator()(double offset_s) const {
    const std::vector<PosePair> pairs = pairs_at(offset_s);
    if (pairs.size() < std::max<std::size_t>(3, fewest_)) return std::numeric_limits<double>::infinity();
    return std::sqrt(mean_squared_error(pairs, align_rigidly(pairs)));
  }

 private:
  static constexpr double kFewest = 0.8;

  std::vector<PosePair> pairs_at(double offset_s) const {
    Trajectory shifted = estimate_;
    for (StampedPose& pose : shifted) pose.t += duration_from_seconds(offset_s);
    return associate(truth_, shifted, max_gap_).pairs;
  }

  const Trajectory& truth_;
  Duration max_gap_;
  Trajectory estimate_;
  std::size_t fewest_ = 0;
  double compared_s_ = 0.0;
};

/// The chance that errors without an offset fit one so well. Those of an odometry are correlated over about a second
/// (residuals of a short recording show less, as they are fitted), so a second has three that are independent; seven
/// of all go into alignment and offset. Fisher's F test with n degrees of freedom, of two parameters as the offset is
/// searched for: (1 + 2 F / n)^(-n / 2).
double chance_of(const TimeOffset& offset) {
  constexpr double kCorrelated_s = 1.0, kFitted = 7.0;
  return std::pow(offset.ate_rmse_m / offset.ate_given_m, 3.0 * offset.compared_s / kCorrelated_s - kFitted);
}

TimeOffset fit(const Trajectory& truth, const Trajectory& estimate, Duration max_gap) {
  const Errors error(truth, estimate, max_gap);
  const double given = error(0.0);
  if (!std::isfinite(given)) return {};
  TimeOffset best{0.0, given, given, error.compared_s()};
  const auto consider = [&](double offset_s) {
    const double ate_m = error(offset_s);
    if (ate_m < best.ate_rmse_m) best.offset_s = offset_s, best.ate_rmse_m = ate_m;
  };
  for (double offset_s = -kMost_s; offset_s <= kMost_s; offset_s += kCoarse_s) consider(offset_s);
  for (double step_s = kCoarse_s / 2; step_s > 1e-4; step_s /= 2) {
    const double middle_s = best.offset_s;
    for (const double sign : {-1.0, 1.0}) consider(middle_s + sign * step_s);
  }
  return best;
}

}  // namespace

bool TimeOffset::matters() const {
  constexpr double kLeast_s = 0.005, kClearlyLess = 0.7, kAlike = 0.5, kByChance = 1e-3;
  return std::abs(offset_s) > kLeast_s && ate_rmse_m < kClearlyLess * ate_given_m &&
         spread_s < kAlike * std::abs(offset_s) && chance_of(*this) < kByChance;
}

TimeOffset fit_time_offset(const Trajectory& truth, const Trajectory& estimate, Duration max_gap) {
  TimeOffset all = fit(truth, estimate, max_gap);
  if (!all.matters()) return all;
  constexpr std::size_t kPieces = 3;
  double least_s = kMost_s, most_s = -kMost_s;
  for (std::size_t i = 0; i < kPieces; ++i) {
    const auto from = estimate.begin() + static_cast<std::ptrdiff_t>(i * estimate.size() / kPieces);
    const auto to = estimate.begin() + static_cast<std::ptrdiff_t>((i + 1) * estimate.size() / kPieces);
    const Trajectory piece(from, to);
    const Errors error(truth, piece, max_gap);
    const double most_m = std::max(error(0.0), error(all.offset_s));
    if (!std::isfinite(most_m) || most_m < kTold * all.ate_given_m) continue;  // without ground truth, or at rest
    const double offset_s = fit(truth, piece, max_gap).offset_s;
    least_s = std::min(least_s, offset_s);
    most_s = std::max(most_s, offset_s);
  }
  all.spread_s = std::max(0.0, most_s - least_s);
  return all;
}

}  // namespace edged
