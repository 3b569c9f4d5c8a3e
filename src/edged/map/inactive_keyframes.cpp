// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/inactive_keyframes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace edged {
namespace {

using Eigen::MatrixXd;

constexpr double kNegligible = 1e-6;  // gain of a parent [m, rad per m, rad]

bool has_parent(const ConditionalPose& pose, std::size_t keyframe) {
  return std::ranges::find(pose.parents, keyframe, &ConditionalPose::Parent::keyframe) != pose.parents.end();
}

void add_parent(ConditionalPose& pose, std::uint32_t keyframe, const Matrix6d& gain) {
  const auto known = std::ranges::find(pose.parents, keyframe, &ConditionalPose::Parent::keyframe);
  if (known == pose.parents.end()) {
    pose.parents.push_back({keyframe, gain});
  } else {
    known->gain += gain;
  }
}

void drop_negligible(ConditionalPose& pose) {
  std::erase_if(pose.parents,
                [](const ConditionalPose::Parent& p) { return p.gain.lpNorm<Eigen::Infinity>() < kNegligible; });
}

/// Bayes' rule, an arc reversal: `child` loses its parent `parent`, which is conditioned on `child` instead. Their
/// joint distribution stays. If `parent` got too many parents it stays as it is, which is its distribution for an
/// unknown `child`.
void reverse(ConditionalPose& child, ConditionalPose& parent) {
  const auto arc = std::ranges::find(child.parents, parent.keyframe, &ConditionalPose::Parent::keyframe);
  const Matrix6d G = arc->gain, GQ = G * parent.covariance;
  child.parents.erase(arc);
  for (const ConditionalPose::Parent& p : parent.parents) add_parent(child, p.keyframe, G * p.gain);
  child.covariance += GQ * G.transpose();
  drop_negligible(child);
  const Matrix6d K =
      Matrix6d(child.covariance + ConditionalPose::kLeastVariance * Matrix6d::Identity()).ldlt().solve(GQ).transpose();
  ConditionalPose posterior = parent;
  for (const ConditionalPose::Parent& p : child.parents) add_parent(posterior, p.keyframe, -K * p.gain);
  add_parent(posterior, child.keyframe, K);
  const Matrix6d left = parent.covariance - K * GQ;
  posterior.covariance = 0.5 * (left + left.transpose());
  drop_negligible(posterior);
  if (posterior.parents.size() <= InactiveKeyframes::kMostParents) parent = std::move(posterior);
}

}  // namespace

ConditionalPose conditional_pose(std::uint32_t keyframe, std::span<const std::uint32_t> parents,
                                 const MatrixXd& joint) {
  const Eigen::Index n = joint.rows() - 6;
  const MatrixXd P = joint.bottomRightCorner(n, n);
  const MatrixXd gain = MatrixXd(P + ConditionalPose::kLeastVariance * MatrixXd::Identity(n, n))
                            .ldlt()
                            .solve(joint.bottomLeftCorner(n, 6))
                            .transpose();
  const Matrix6d left = joint.topLeftCorner<6, 6>() - gain * P * gain.transpose();
  ConditionalPose pose{keyframe, {}, 0.5 * (left + left.transpose())};
  for (std::size_t i = 0; i < parents.size(); ++i)
    pose.parents.push_back({parents[i], gain.middleCols<6>(6 * static_cast<Eigen::Index>(i))});
  return pose;
}

void InactiveKeyframes::add(ConditionalPose pose) {
  if (order_.size() <= pose.keyframe) order_.resize(pose.keyframe + 1, kActive);
  order_[pose.keyframe] = ++newest_;
  poses_.emplace(newest_, std::move(pose));
}

/// The last that was deactivated first: so it becomes a possible parent of the others, and no arcs are reversed.
std::vector<ConditionalPose> InactiveKeyframes::activate(std::span<const std::uint32_t> keyframes) {
  std::set<std::uint64_t, std::greater<>> orders;
  for (const std::uint32_t keyframe : keyframes) {
    if (contains(keyframe)) orders.insert(order_[keyframe]);
  }
  std::vector<ConditionalPose> activated;
  for (const std::uint64_t order : orders) activated.push_back(activate(order));
  return activated;
}

/// Among the arcs from its inactive parents that to the one deactivated first is reversed first: none of the other
/// parents depends on that one.
ConditionalPose InactiveKeyframes::activate(std::uint64_t order) {
  ConditionalPose pose = std::move(poses_.extract(order).mapped());
  order_[pose.keyframe] = kActive;
  for (;;) {
    std::uint64_t first = newest_ + 1;
    for (const ConditionalPose::Parent& p : pose.parents) {
      if (contains(p.keyframe)) first = std::min(first, order_[p.keyframe]);
    }
    if (first > newest_) return pose;
    reverse(pose, poses_.at(first));
  }
}

/// Arcs are reversed until it is no keyframe's parent: that of the child deactivated last first, as no other path leads
/// to it.
void InactiveKeyframes::remove(std::size_t keyframe) {
  const auto number = static_cast<std::uint32_t>(keyframe);
  if (contains(keyframe)) {
    ConditionalPose pose = std::move(poses_.extract(order_[keyframe]).mapped());
    for (auto other = poses_.rbegin(); other != poses_.rend(); ++other) {
      if (has_parent(other->second, number)) reverse(other->second, pose);
    }
  }
  if (keyframe < order_.size()) order_.erase(order_.begin() + static_cast<std::ptrdiff_t>(keyframe));
  for (auto& [order, pose] : poses_) {
    pose.keyframe -= pose.keyframe > number ? 1 : 0;
    for (ConditionalPose::Parent& p : pose.parents) p.keyframe -= p.keyframe > number ? 1 : 0;
  }
}

bool InactiveKeyframes::depend_on(std::size_t keyframe) const {
  return std::ranges::any_of(poses_, [&](const auto& each) { return has_parent(each.second, keyframe); });
}

void InactiveKeyframes::follow(std::span<Vector6d> errors) const {
  for (auto each = poses_.rbegin(); each != poses_.rend(); ++each) {
    const ConditionalPose& pose = each->second;
    Vector6d& error = errors[pose.keyframe];
    error.setZero();
    for (const ConditionalPose::Parent& p : pose.parents) error += p.gain * errors[p.keyframe];
  }
}

/// The keyframes' errors by those of others, replaced by their parents until all are active.
MatrixXd InactiveKeyframes::joint(std::span<const std::uint32_t> keyframes,
                                  const std::function<Matrix6d(std::uint32_t, std::uint32_t)>& active) const {
  const Eigen::Index n = 6 * std::ssize(keyframes);
  MatrixXd P = MatrixXd::Zero(n, n);
  std::map<std::uint64_t, MatrixXd> by_inactive;  // by order
  std::map<std::uint32_t, MatrixXd> by_active;
  const auto add = [&](std::uint32_t keyframe, const MatrixXd& by) {
    MatrixXd& sum = contains(keyframe) ? by_inactive[order_[keyframe]] : by_active[keyframe];
    sum = sum.size() == 0 ? by : MatrixXd(sum + by);
  };
  for (Eigen::Index i = 0; i < n; i += 6)
    add(keyframes[static_cast<std::size_t>(i / 6)], MatrixXd::Identity(n, n).middleCols(i, 6));
  while (!by_inactive.empty()) {
    const auto first = by_inactive.extract(by_inactive.begin());
    const ConditionalPose& pose = poses_.at(first.key());
    P += first.mapped() * pose.covariance * first.mapped().transpose();
    for (const ConditionalPose::Parent& p : pose.parents) add(p.keyframe, first.mapped() * p.gain);
  }
  for (const auto& [a, by_a] : by_active) {
    for (const auto& [b, by_b] : by_active) P += by_a * active(a, b) * by_b.transpose();
  }
  return P;
}

std::vector<ConditionalPose> InactiveKeyframes::poses() const {
  std::vector<ConditionalPose> all;
  for (const auto& [order, pose] : poses_) all.push_back(pose);
  return all;
}

}  // namespace edged
