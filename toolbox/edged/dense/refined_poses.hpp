// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Poses of packets, refined by what the window has estimated of the keyframes around them when it marginalizes these.
#pragma once

#include <deque>
#include <optional>

#include "edged/state.hpp"

namespace edged {

/// Causal poses of successive packets do not fit each other as well as stereo needs: the error of a keyframe's causal
/// pose, in the body frame, is interpolated in between. Of one odometry frame O; bounded memory.
class RefinedPoses {
 public:
  /// A keyframe, as it was estimated at its time.
  void add_keyframe(const StampedPose& T_O_B);
  /// A keyframe that was added, when it is marginalized.
  void refine(const StampedPose& T_O_B);

  /// The newest refined keyframe.
  std::optional<Timestamp> known_until() const;
  /// The refined pose for a causal one; beyond the refined keyframes with the correction of the nearest one.
  SE3 operator()(const StampedPose& T_O_B) const;

 private:
  std::deque<StampedPose> causal_;       // T_O_B of keyframes that are not refined yet
  std::deque<StampedPose> corrections_;  // T_causal_refined
};

}  // namespace edged
