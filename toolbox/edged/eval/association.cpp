// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/association.hpp"

#include "edged/core/check.hpp"

namespace edged {
namespace {

void require_ascending(const Trajectory& trajectory, const char* what) {
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    if (trajectory[i].t < trajectory[i - 1].t) {
      throw InputError::format("the {} is not in time order at pose {} of {}; sort it by stamp", what, i + 1,
                               trajectory.size());
    }
  }
}

SE3 between(const StampedPose& before, const StampedPose& after, Timestamp t) {
  const double span = to_seconds(after.t - before.t);
  const double a = span > 0.0 ? to_seconds(t - before.t) / span : 0.0;
  return {before.T.rotation().slerp(a, after.T.rotation()),
          (1.0 - a) * before.T.translation() + a * after.T.translation()};
}

}  // namespace

Association associate(const Trajectory& truth, const Trajectory& estimate, Duration max_gap) {
  require_ascending(truth, "ground truth");
  require_ascending(estimate, "estimate");
  Association result;
  result.pairs.reserve(estimate.size());
  if (!truth.empty()) result.truth_begin = truth.front().t;
  std::size_t after = 0;  // first true pose at or after the estimate's stamp
  for (const StampedPose& pose : estimate) {
    while (after < truth.size() && truth[after].t < pose.t) ++after;
    if (after == truth.size() || (after == 0 && truth[0].t != pose.t)) {
      ++result.outside;
    } else if (truth[after].t == pose.t) {
      result.pairs.push_back({pose.t, truth[after].T, pose.T});
    } else if (truth[after].t - truth[after - 1].t > max_gap) {
      ++result.in_gaps;
    } else {
      result.pairs.push_back({pose.t, between(truth[after - 1], truth[after], pose.t), pose.T});
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
  if (!truth.empty()) result.truth_begin = truth.front().t;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    result.pairs.push_back({truth[i].t, truth[i].T, estimate[i].T});
  }
  return result;
}

}  // namespace edged
