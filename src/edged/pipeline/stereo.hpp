// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Features that several cameras of one kind observe at one instant. They keep their id, so they become one landmark.
#pragma once

#include <functional>
#include <optional>

#include "edged/options/frontend.hpp"
#include "edged/pipeline/body_motion.hpp"
#include "edged/pipeline/channel.hpp"

namespace edged {

/// z-depth of a feature in a camera [m], where known.
using DepthOf = std::function<std::optional<double>(const Channel& channel, FeatureId id)>;

// Of views of one kind, if that is enabled; of an event camera and a frame camera nothing: they differ in appearance.

/// Follows features of `from` in `to`, too, up to `most` tracks there.
void share_features(const ChannelView& from, const ChannelView& to, const BodyMotion& body, const DepthOf& depth,
                    int most, const StereoConfig& config);

/// Ends the tracks of `to` that have left the epipolar line of the same feature in `from`.
void drop_mismatches(const ChannelView& from, const ChannelView& to, const BodyMotion& body,
                     const StereoConfig& config);

}  // namespace edged
