// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/association.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr Duration kMaxDifference = std::chrono::milliseconds(10);  ///< of the stamps of a nearest pose

void require_ascending(const Trajectory& trajectory, const char* what) {
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    if (trajectory[i].t < trajectory[i - 1].t) {
      throw InputError::format("the {} is not in time order at pose {} of {}; sort it by stamp", what, i + 1,
                               trajectory.size());
    }
  }
}

std::size_t count_outside(const Trajectory& truth, const Trajectory& estimate) {
  return static_cast<std::size_t>(std::ranges::count_if(estimate, [&truth](const StampedPose& pose) {
    return truth.empty() || pose.t < truth.front().t || pose.t > truth.back().t;
  }));
}

/// after: the first pose that is not before t, or their number.
std::optional<SE3> pose_at(const Trajectory& dense, std::size_t after, Timestamp t, Duration max_gap,
                           Matching matching) {
  const StampedPose* const before = after > 0 ? &dense[after - 1] : nullptr;
  const StampedPose* const next = after < dense.size() ? &dense[after] : nullptr;
  if (next && next->t == t) return next->T;
  if (matching == Matching::Nearest) {
    const StampedPose* const nearest = before && (!next || t - before->t < next->t - t) ? before : next;
    return nearest && std::chrono::abs(nearest->t - t) <= kMaxDifference ? std::optional(nearest->T) : std::nullopt;
  }
  const bool between = before && next && next->t - before->t <= max_gap;
  return between ? std::optional(interpolated(*before, *next, t)) : std::nullopt;
}

}  // namespace

Duration typical_step(const Trajectory& trajectory) {
  std::vector<Duration> steps;
  for (std::size_t i = 1; i < trajectory.size(); ++i) steps.push_back(trajectory[i].t - trajectory[i - 1].t);
  if (steps.empty()) return Duration::max();
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

SE3 interpolated(const StampedPose& before, const StampedPose& after, Timestamp t) {
  const double span = to_seconds(after.t - before.t);
  const double a = span > 0.0 ? to_seconds(t - before.t) / span : 0.0;
  return {before.T.rotation().slerp(a, after.T.rotation()),
          (1.0 - a) * before.T.translation() + a * after.T.translation()};
}

Association associate(const Trajectory& truth, const Trajectory& estimate, Duration max_gap, Matching matching) {
  require_ascending(truth, "ground truth");
  require_ascending(estimate, "estimate");
  Association result;
  result.outside = count_outside(truth, estimate);
  if (!estimate.empty()) result.estimate_begin = estimate.front().t;
  const bool truth_is_denser = typical_step(truth) <= typical_step(estimate);
  const Trajectory& dense = truth_is_denser ? truth : estimate;
  const auto add = [&](const StampedPose& pose, const SE3& T) {
    result.pairs.push_back({pose.t, truth_is_denser ? T : pose.T, truth_is_denser ? pose.T : T});
  };
  std::size_t after = 0;  // first pose of the denser one at or after the stamp
  for (const StampedPose& pose : truth_is_denser ? estimate : truth) {
    while (after < dense.size() && dense[after].t < pose.t) ++after;
    if (const auto T = pose_at(dense, after, pose.t, max_gap, matching)) {
      add(pose, *T);
    } else if (after > 0 && after < dense.size()) {
      ++result.in_gaps;
    }
  }
  return result;
}

Association associate_by_index(const Trajectory& truth, const Trajectory& estimate) {
  if (truth.size() != estimate.size()) {
    throw InputError::format("{} true poses against {} estimated ones; pairing by line needs as many of each",
                             truth.size(), estimate.size());
  }
  Association result;
  if (!estimate.empty()) result.estimate_begin = estimate.front().t;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    result.pairs.push_back({truth[i].t, truth[i].T, estimate[i].T});
  }
  return result;
}

}  // namespace edged
