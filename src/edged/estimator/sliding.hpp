// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How the window moves on: states that leave, and what is kept of them.
#pragma once

#include "edged/estimator/landmarks.hpp"
#include "edged/estimator/window.hpp"
#include "edged/keyframe_record.hpp"

namespace edged {

/// A state that is no keyframe leaves by joining its IMU interval to the next one's, which is exact; where that would
/// be longer than max_interval_s, it becomes a keyframe. At rest it may be ten times as long: keyframes there would
/// push those with a baseline out of the window, and the body is held between them.
void drop_or_promote(Window& window, StateId id, double max_interval_s);

/// Marginalises the oldest state and gives what is left of it. Landmarks anchored there that are still in view go on in
/// the youngest keyframe with the observations from there on, so that nothing is used twice.
KeyframeRecord drop_oldest_keyframe(Window& window, const LandmarkConfig& config);

/// A scalar that walks has jumped: it goes with its factors, and out of the prior.
void forget_walk(Window& window, BlockKind kind);

}  // namespace edged
