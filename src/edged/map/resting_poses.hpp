// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Keyframes away from the body: their pose errors, each given those of few other keyframes. A Gaussian network:
// together with the joint covariance of all other keyframes it is the joint covariance of all.
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

/// The error of a keyframe's pose given those of others: the sum of gain * error of each, and an independent error.
struct TiedPose {
  static constexpr double kLeastVariance = 1e-12;  ///< keeps inverses finite [m^2, rad^2]

  struct Tie {
    std::uint32_t to = 0;  ///< keyframe
    Matrix6d gain = Matrix6d::Zero();
  };
  std::uint32_t keyframe = 0;
  std::vector<Tie> ties;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the independent error
};

/// By the joint covariance of the keyframe and of those it is to be tied to, in this order, six rows each.
TiedPose tied_pose(std::uint32_t keyframe, std::span<const std::uint32_t> to, const Eigen::MatrixXd& joint);

class RestingPoses {
 public:
  static constexpr std::size_t kMostTies = 12;  ///< of one pose

  /// The pose comes to rest, tied to keyframes that do not rest.
  void rest(TiedPose pose);
  /// Those of the keyframes that rest do so no more: their poses, each tied to keyframes that did not rest, or to those
  /// before it. What they had in common with poses that rest on is in these, as ties to them.
  std::vector<TiedPose> wake(std::span<const std::uint32_t> keyframes);
  /// Forgets a keyframe that rests or that none is tied to. Keyframes after it get a number less.
  void remove(std::size_t keyframe);

  bool empty() const { return poses_.empty(); }
  bool contains(std::size_t keyframe) const { return keyframe < order_.size() && order_[keyframe] != kAwake; }
  /// Whether one that rests is tied to that keyframe.
  bool depend_on(std::size_t keyframe) const;
  /// The errors of those that rest as far as they follow from those of the others; errors: one per keyframe of the map.
  void follow(std::span<Vector6d> errors) const;
  /// Joint covariance of these keyframes, six rows each; awake: of two that do not rest.
  Eigen::MatrixXd joint(std::span<const std::uint32_t> keyframes,
                        const std::function<Matrix6d(std::uint32_t, std::uint32_t)>& awake) const;
  /// By the order in which they came to rest: tied to those that do not rest and to later ones.
  std::vector<TiedPose> poses() const;

 private:
  TiedPose wake(std::uint64_t order);

  static constexpr std::uint64_t kAwake = 0;
  std::map<std::uint64_t, TiedPose> poses_;  ///< by the order in which they came to rest
  std::vector<std::uint64_t> order_;         ///< the same by keyframe
  std::uint64_t newest_ = kAwake;
};

}  // namespace edged
