// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How the window slides: states that are dropped or marginalized, and what is kept of them.
#pragma once

#include "edged/estimator/window/landmarks.hpp"
#include "edged/estimator/window/start_record.hpp"
#include "edged/estimator/window/window.hpp"
#include "edged/keyframe_record.hpp"

namespace edged {

/// Drops a state that is no keyframe by joining its IMU interval to the next one, which is exact; if that would be
/// longer than max_interval_s, the state becomes a keyframe. At standstill the interval may be ten times as long:
/// keyframes there would replace those with a baseline, and the standstill factor fixes the body between them.
void drop_or_promote(Window& window, StateId id, double max_interval_s);

/// What the window has estimated of a keyframe when it is marginalized, in the odometry frame.
struct MarginalizedKeyframe {
  Timestamp t;
  SE3 T_O_B;
  std::vector<KeyframeView> views;
};

/// Marginalizes the oldest state and returns its record. Landmarks anchored there that are still observed move to the
/// youngest keyframe with the observations from there on, so that no measurement is used twice. What leaves is added to
/// `all`, if there is one.
MarginalizedKeyframe drop_oldest_keyframe(Window& window, const LandmarkConfig& config, StartRecord* all = nullptr);

/// The records of all keyframes of a window, oldest first.
std::vector<MarginalizedKeyframe> keyframe_records(const Window& window);

/// Removes a random-walk parameter that has jumped, with its factors, and from the prior.
void marginalize_parameter(Window& window, BlockKind kind);

}  // namespace edged
