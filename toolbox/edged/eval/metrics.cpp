// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/directions.hpp"
#include "edged/core/path_length.hpp"

namespace edged {
namespace {

constexpr double kDeltaTolerance = 0.1;  // share of delta by which a pair may come late
constexpr double kStart_s = 5.0;
constexpr TimeWindow kFirst = {0.0, 2.0}, kLater = {10.0, 12.0};
constexpr double kLeastStartPath_m = 0.1;  // less does not determine the scale
constexpr double kLocalAfter_s = 4.0;      // earlier errors are those of initialization
constexpr double kLocalSteps = 4.0;        // number of windows that begin within the length of one
constexpr std::size_t kLeastLocalPairs = 11;

double angle_deg(const Eigen::Quaterniond& q) { return kDegreesPerRadian * so3::log(q).norm(); }

/// Yaw of the rotation that turns the estimate into the truth, seen in the world.
double yaw_error_deg(const SE3& truth, const SE3& estimate) {
  const Eigen::Matrix3d R = (truth.rotation() * estimate.rotation().conjugate()).toRotationMatrix();
  return kDegreesPerRadian * std::abs(std::atan2(R(1, 0), R(0, 0)));
}

/// Angle between the directions of up in the sensor's frame.
double tilt_error_deg(const PosePair& pair) {
  return kDegreesPerRadian * angle_between(pair.truth.R().row(2), pair.estimate.R().row(2));
}

std::vector<PosePair> aligned(std::vector<PosePair> pairs, const Similarity& alignment) {
  for (PosePair& pair : pairs) pair.estimate = alignment * pair.estimate;
  return pairs;
}

/// NaN when the positions do not determine it.
double sim3_scale(const std::vector<PosePair>& pairs) {
  try {
    return align(pairs, AlignmentKind::Sim3).scale;
  } catch (const InputError&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

double start_scale(const std::vector<PosePair>& pairs) {
  const std::vector<PosePair> start = within(pairs, {0.0, kStart_s});
  return path_length(start, &PosePair::truth) < kLeastStartPath_m ? std::numeric_limits<double>::quiet_NaN()
                                                                  : sim3_scale(start);
}

/// The true over the estimated extent. Defined for straight motion, too, where Sim(3) is not. NaN with too little
/// motion.
double extent_ratio(const std::vector<PosePair>& pairs) {
  if (path_length(pairs, &PosePair::truth) < kLeastStartPath_m) return std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(pairs.size());
  Eigen::Vector3d true_mean = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    true_mean += pair.truth.translation() / n;
    mean += pair.estimate.translation() / n;
  }
  double true_extent = 0.0, extent = 0.0;
  for (const PosePair& pair : pairs) {
    true_extent += (pair.truth.translation() - true_mean).squaredNorm();
    extent += (pair.estimate.translation() - mean).squaredNorm();
  }
  return std::sqrt(true_extent / extent);
}

}  // namespace

Statistics statistics(std::vector<double> errors) {
  Statistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  const double n = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  s.min = errors.front();
  s.max = errors.back();
  const std::size_t middle = errors.size() / 2;
  s.median = errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  double variance = 0.0;
  for (const double e : errors) {
    s.sse += e * e;
    variance += (e - s.mean) * (e - s.mean) / n;
  }
  s.rmse = std::sqrt(s.sse / n);
  s.std = std::sqrt(variance);
  return s;
}

Protocol protocol(std::string_view name) {
  if (name == "P1") return {"P1", AlignmentKind::SE3, {3.0, 8.0}};
  if (name == "P2") return {"P2", AlignmentKind::SE3, {0.0, 5.0}};
  if (name == "P3") return {"P3", AlignmentKind::SE3, {}};
  if (name == "P4") return {"P4", AlignmentKind::Sim3, {}};
  throw InputError::format("unknown protocol '{}'; use P1, P2, P3 or P4", name);
}

RelativeError relative_error(const std::vector<PosePair>& pairs, double delta_s) {
  const Duration delta = duration_from_seconds(delta_s);
  const Duration latest = duration_from_seconds(delta_s * (1.0 + kDeltaTolerance));
  std::vector<double> translation, rotation;
  std::size_t j = 0;
  for (const PosePair& from : pairs) {
    while (j < pairs.size() && pairs[j].t - from.t < delta) ++j;
    if (j == pairs.size()) break;
    if (pairs[j].t - from.t > latest) continue;
    const SE3 true_motion = from.truth.inverse() * pairs[j].truth;
    const SE3 error = true_motion.inverse() * (from.estimate.inverse() * pairs[j].estimate);
    translation.push_back(error.translation().norm());
    rotation.push_back(angle_deg(error.rotation()));
  }
  return {delta_s, statistics(std::move(translation)), statistics(std::move(rotation))};
}

LocalError local_error(const Association& association, double window_s) {
  const std::vector<PosePair>& pairs = association.pairs;
  LocalError result{window_s, 0, std::numeric_limits<double>::quiet_NaN()};
  if (pairs.empty()) return result;
  const Duration length = duration_from_seconds(window_s), step = duration_from_seconds(window_s / kLocalSteps);
  EDGED_CHECK(step > Duration{0}, "windows of {} s", window_s);
  const auto before = [](const PosePair& pair, Timestamp t) { return pair.t < t; };
  double sum = 0.0;
  auto first = pairs.begin();
  for (Timestamp t = std::max(pairs.front().t, association.estimate_begin + duration_from_seconds(kLocalAfter_s));
       t + length < pairs.back().t; t += step) {
    first = std::lower_bound(first, pairs.end(), t, before);
    const auto last = std::lower_bound(first, pairs.end(), t + length, before);
    const std::vector<PosePair> window(first, last);
    if (window.size() < kLeastLocalPairs) continue;
    sum += mean_squared_error(window, align_rigidly(window));
    ++result.windows;
  }
  if (result.windows > 0) result.rmse_m = std::sqrt(sum / static_cast<double>(result.windows));
  return result;
}

Evaluation evaluate(const Association& association, const Protocol& protocol, const std::vector<double>& deltas_s,
                    std::span<const double> local_windows_s) {
  if (association.pairs.empty()) {
    throw InputError::format(
        "no estimated pose has ground truth ({} outside its time span, {} where neighbours are too far apart to "
        "interpolate); do the stamps share one clock? A longer --max-gap bridges gaps",
        association.outside, association.in_gaps);
  }
  Evaluation result;
  result.protocol = protocol;
  result.pairs = association.pairs.size();
  result.outside = association.outside;
  result.in_gaps = association.in_gaps;
  result.duration_s = to_seconds(association.pairs.back().t - association.pairs.front().t);
  result.path_length_m = path_length(association.pairs, &PosePair::truth);
  result.alignment = align(within(association.pairs, protocol.window), protocol.alignment);
  result.scale = sim3_scale(association.pairs);
  result.start_scale = start_scale(association.pairs);
  result.first_scale = extent_ratio(within(association.pairs, kFirst));
  result.later_scale = extent_ratio(within(association.pairs, kLater));

  const std::vector<PosePair> pairs = aligned(association.pairs, result.alignment);
  std::vector<double> position, rotation, yaw, tilt;
  for (const PosePair& pair : association.pairs) tilt.push_back(tilt_error_deg(pair));
  for (const PosePair& pair : pairs) {
    position.push_back((pair.truth.translation() - pair.estimate.translation()).norm());
    rotation.push_back(angle_deg(pair.truth.rotation().conjugate() * pair.estimate.rotation()));
    yaw.push_back(yaw_error_deg(pair.truth, pair.estimate));
  }
  result.ate_m = statistics(std::move(position));
  result.rotation_deg = statistics(std::move(rotation));
  result.yaw_deg = statistics(std::move(yaw));
  result.tilt_deg = statistics(std::move(tilt));
  const bool is_short = result.path_length_m < kShortestPath_m;
  if (is_short) result.scale = std::numeric_limits<double>::quiet_NaN();
  const double per_metre = is_short ? std::numeric_limits<double>::quiet_NaN() : 1.0 / result.path_length_m;
  result.mpe_percent = 100.0 * result.ate_m.mean * per_metre;
  result.rotation_deg_per_m = result.rotation_deg.mean * per_metre;
  result.yaw_deg_per_m = result.yaw_deg.mean * per_metre;
  for (const double delta_s : deltas_s) result.relative.push_back(relative_error(pairs, delta_s));
  for (const double window_s : local_windows_s) result.local.push_back(local_error(association, window_s));
  return result;
}

}  // namespace edged
