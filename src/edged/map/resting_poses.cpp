// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/resting_poses.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace edged {
namespace {

using Eigen::MatrixXd;

constexpr double kNegligible = 1e-6;  // gain of a tie [m, rad per m, rad]

bool tied(const TiedPose& pose, std::size_t to) {
  return std::ranges::find(pose.ties, to, &TiedPose::Tie::to) != pose.ties.end();
}

void tie(TiedPose& pose, std::uint32_t to, const Matrix6d& gain) {
  const auto known = std::ranges::find(pose.ties, to, &TiedPose::Tie::to);
  if (known == pose.ties.end()) {
    pose.ties.push_back({to, gain});
  } else {
    known->gain += gain;
  }
}

void drop_negligible(TiedPose& pose) {
  std::erase_if(pose.ties, [](const TiedPose::Tie& t) { return t.gain.lpNorm<Eigen::Infinity>() < kNegligible; });
}

/// Bayes' rule: `pose`, tied to `former`, is no longer; `former` is tied to `pose` instead. Their joint distribution
/// stays. If `former` got too many ties it stays as it is, which is its distribution for an unknown `pose`.
void turn(TiedPose& pose, TiedPose& former) {
  const auto between = std::ranges::find(pose.ties, former.keyframe, &TiedPose::Tie::to);
  const Matrix6d G = between->gain, GQ = G * former.covariance;
  pose.ties.erase(between);
  for (const TiedPose::Tie& t : former.ties) tie(pose, t.to, G * t.gain);
  pose.covariance += GQ * G.transpose();
  drop_negligible(pose);
  const Matrix6d K =
      Matrix6d(pose.covariance + TiedPose::kLeastVariance * Matrix6d::Identity()).ldlt().solve(GQ).transpose();
  TiedPose given = former;
  for (const TiedPose::Tie& t : pose.ties) tie(given, t.to, -K * t.gain);
  tie(given, pose.keyframe, K);
  const Matrix6d left = former.covariance - K * GQ;
  given.covariance = 0.5 * (left + left.transpose());
  drop_negligible(given);
  if (given.ties.size() <= RestingPoses::kMostTies) former = std::move(given);
}

}  // namespace

TiedPose tied_pose(std::uint32_t keyframe, std::span<const std::uint32_t> to, const MatrixXd& joint) {
  const Eigen::Index n = joint.rows() - 6;
  const MatrixXd P = joint.bottomRightCorner(n, n);
  const MatrixXd gain = MatrixXd(P + TiedPose::kLeastVariance * MatrixXd::Identity(n, n))
                            .ldlt()
                            .solve(joint.bottomLeftCorner(n, 6))
                            .transpose();
  const Matrix6d left = joint.topLeftCorner<6, 6>() - gain * P * gain.transpose();
  TiedPose pose{keyframe, {}, 0.5 * (left + left.transpose())};
  for (std::size_t i = 0; i < to.size(); ++i)
    pose.ties.push_back({to[i], gain.middleCols<6>(6 * static_cast<Eigen::Index>(i))});
  return pose;
}

void RestingPoses::rest(TiedPose pose) {
  if (order_.size() <= pose.keyframe) order_.resize(pose.keyframe + 1, kAwake);
  order_[pose.keyframe] = ++newest_;
  poses_.emplace(newest_, std::move(pose));
}

/// The last that came to rest first: so the others are tied to it, and no ties need to be turned.
std::vector<TiedPose> RestingPoses::wake(std::span<const std::uint32_t> keyframes) {
  std::set<std::uint64_t, std::greater<>> orders;
  for (const std::uint32_t keyframe : keyframes) {
    if (contains(keyframe)) orders.insert(order_[keyframe]);
  }
  std::vector<TiedPose> woken;
  for (const std::uint64_t order : orders) woken.push_back(wake(order));
  return woken;
}

/// Of its ties the one that came to rest first is turned first: none of the others depends on that one.
TiedPose RestingPoses::wake(std::uint64_t order) {
  TiedPose pose = std::move(poses_.extract(order).mapped());
  order_[pose.keyframe] = kAwake;
  for (;;) {
    std::uint64_t first = newest_ + 1;
    for (const TiedPose::Tie& t : pose.ties) {
      if (contains(t.to)) first = std::min(first, order_[t.to]);
    }
    if (first > newest_) return pose;
    turn(pose, poses_.at(first));
  }
}

/// All that are tied to it are turned until none is: the one that came to rest last first, as no other path leads to
/// it.
void RestingPoses::remove(std::size_t keyframe) {
  const auto number = static_cast<std::uint32_t>(keyframe);
  if (contains(keyframe)) {
    TiedPose pose = std::move(poses_.extract(order_[keyframe]).mapped());
    for (auto other = poses_.rbegin(); other != poses_.rend(); ++other) {
      if (tied(other->second, number)) turn(other->second, pose);
    }
  }
  if (keyframe < order_.size()) order_.erase(order_.begin() + static_cast<std::ptrdiff_t>(keyframe));
  for (auto& [order, pose] : poses_) {
    pose.keyframe -= pose.keyframe > number ? 1 : 0;
    for (TiedPose::Tie& t : pose.ties) t.to -= t.to > number ? 1 : 0;
  }
}

bool RestingPoses::depend_on(std::size_t keyframe) const {
  return std::ranges::any_of(poses_, [&](const auto& each) { return tied(each.second, keyframe); });
}

void RestingPoses::follow(std::span<Vector6d> errors) const {
  for (auto each = poses_.rbegin(); each != poses_.rend(); ++each) {
    const TiedPose& pose = each->second;
    Vector6d& error = errors[pose.keyframe];
    error.setZero();
    for (const TiedPose::Tie& t : pose.ties) error += t.gain * errors[t.to];
  }
}

/// The keyframes' errors by those of others, replaced by their ties until none rests.
MatrixXd RestingPoses::joint(std::span<const std::uint32_t> keyframes,
                             const std::function<Matrix6d(std::uint32_t, std::uint32_t)>& awake) const {
  const Eigen::Index n = 6 * std::ssize(keyframes);
  MatrixXd P = MatrixXd::Zero(n, n);
  std::map<std::uint64_t, MatrixXd> by_resting;  // by order
  std::map<std::uint32_t, MatrixXd> by_awake;
  const auto add = [&](std::uint32_t keyframe, const MatrixXd& by) {
    MatrixXd& sum = contains(keyframe) ? by_resting[order_[keyframe]] : by_awake[keyframe];
    sum = sum.size() == 0 ? by : MatrixXd(sum + by);
  };
  for (Eigen::Index i = 0; i < n; i += 6)
    add(keyframes[static_cast<std::size_t>(i / 6)], MatrixXd::Identity(n, n).middleCols(i, 6));
  while (!by_resting.empty()) {
    const auto first = by_resting.extract(by_resting.begin());
    const TiedPose& pose = poses_.at(first.key());
    P += first.mapped() * pose.covariance * first.mapped().transpose();
    for (const TiedPose::Tie& t : pose.ties) add(t.to, first.mapped() * t.gain);
  }
  for (const auto& [a, by_a] : by_awake) {
    for (const auto& [b, by_b] : by_awake) P += by_a * awake(a, b) * by_b.transpose();
  }
  return P;
}

std::vector<TiedPose> RestingPoses::poses() const {
  std::vector<TiedPose> all;
  for (const auto& [order, pose] : poses_) all.push_back(pose);
  return all;
}

}  // namespace edged
