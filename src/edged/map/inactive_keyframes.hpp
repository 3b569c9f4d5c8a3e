// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Inactive keyframes, away from the body: the error of each is conditional on those of few other keyframes, its
// parents. A Gaussian network: together with the joint covariance of the active keyframes it is the joint covariance of
// all.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "edged/se3.hpp"

namespace edged {

/// A conditional Gaussian, the error of a keyframe's pose given those of its parents: the sum of gain * error of each,
/// and an independent error.
struct ConditionalPose {
  static constexpr double kLeastVariance = 1e-12;  ///< keeps inverses finite [m^2, rad^2]

  struct Parent {
    std::uint32_t keyframe = 0;
    Matrix6d gain = Matrix6d::Zero();
  };
  std::uint32_t keyframe = 0;
  std::vector<Parent> parents;
  Matrix6d covariance = Matrix6d::Zero();  ///< that of the independent error
};

/// By the joint covariance of the keyframe and of those that become its parents, in this order, six rows each.
ConditionalPose conditional_pose(std::uint32_t keyframe, std::span<const std::uint32_t> parents,
                                 const Eigen::MatrixXd& joint);

class InactiveKeyframes {
 public:
  static constexpr std::size_t kMostParents = 12;  ///< a pose has at most

  /// The keyframe is deactivated; its parents are active.
  void add(ConditionalPose pose);
  /// Activates the keyframes that are inactive. Returns their poses, with parents that were active, or before it in
  /// this list. What they had in common with keyframes that stay inactive is in these, which get them as parents.
  std::vector<ConditionalPose> activate(std::span<const std::uint32_t> keyframes);
  /// Forgets a keyframe that is inactive or no parent. Keyframes after it get a number less.
  void remove(std::size_t keyframe);

  bool empty() const { return poses_.empty(); }
  bool contains(std::size_t keyframe) const { return keyframe < order_.size() && order_[keyframe] != kActive; }
  /// Whether that keyframe is a parent of an inactive one.
  bool depend_on(std::size_t keyframe) const;
  /// The expected errors of the inactive keyframes given those of the active ones; errors: one per keyframe of the map.
  void follow(std::span<Vector6d> errors) const;
  /// Joint covariance of these keyframes, six rows each; active: of two active ones.
  Eigen::MatrixXd joint(std::span<const std::uint32_t> keyframes,
                        const std::function<Matrix6d(std::uint32_t, std::uint32_t)>& active) const;
  /// In the order of their deactivation: the parents of each are active or later in this list.
  std::vector<ConditionalPose> poses() const;

 private:
  ConditionalPose activate(std::uint64_t order);

  static constexpr std::uint64_t kActive = 0;
  std::map<std::uint64_t, ConditionalPose> poses_;  ///< by the order of their deactivation
  std::vector<std::uint64_t> order_;                ///< keys of poses_ by keyframe
  std::uint64_t newest_ = kActive;
};

}  // namespace edged
