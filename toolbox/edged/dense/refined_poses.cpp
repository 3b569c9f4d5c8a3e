// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/refined_poses.hpp"

#include <algorithm>
#include <cstddef>

#include "edged/se3.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostKeyframes = 100;  // no window holds as many

}  // namespace

void RefinedPoses::add_keyframe(const StampedPose& T_O_B) {
  causal_.push_back(T_O_B);
  if (causal_.size() > kMostKeyframes) causal_.pop_front();
}

void RefinedPoses::refine(const StampedPose& T_O_B) {
  while (!causal_.empty() && causal_.front().t < T_O_B.t) causal_.pop_front();
  if (causal_.empty() || causal_.front().t != T_O_B.t) return;
  corrections_.push_back({T_O_B.t, causal_.front().T.inverse() * T_O_B.T});
  causal_.pop_front();
  if (corrections_.size() > kMostKeyframes) corrections_.pop_front();
}

std::optional<Timestamp> RefinedPoses::known_until() const {
  return corrections_.empty() ? std::nullopt : std::optional(corrections_.back().t);
}

SE3 RefinedPoses::operator()(const StampedPose& T_O_B) const {
  if (corrections_.empty()) return T_O_B.T;
  const auto after = std::ranges::lower_bound(corrections_, T_O_B.t, {}, &StampedPose::t);
  if (after == corrections_.begin()) return T_O_B.T * corrections_.front().T;
  if (after == corrections_.end()) return T_O_B.T * corrections_.back().T;
  const StampedPose& before = *(after - 1);
  return T_O_B.T * interpolate(before.T, after->T, to_seconds(T_O_B.t - before.t) / to_seconds(after->t - before.t));
}

}  // namespace edged
