// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Features that several cameras observe at one instant. They keep their id, so they become one landmark.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "edged/options/frontend.hpp"
#include "edged/pipeline/localization/imu_propagator.hpp"
#include "edged/pipeline/vision/camera_tracker.hpp"

namespace edged {

/// z-depth of a feature in a camera [m], where known.
using DepthOf = std::function<std::optional<double>(const CameraTracker& tracker, FeatureId id)>;

/// Whether two cameras can share features: both of one kind, or the only event camera and the only frame camera, behind
/// different lenses. One lens for both gives no depth; two of a kind give it more accurately.
bool can_match(const CameraTracker& one, const CameraTracker& other, const StereoConfig& config);

// Functions on cameras that can match. Between events and frames a frame is compared as event cameras would see it.

/// Follows features of `from` in `to`, too, up to `most` tracks there.
void match_across_cameras(const CameraImage& from, const CameraImage& to, const ImuPropagator& body,
                          const DepthOf& depth, int most, const StereoConfig& config);

/// Raises the sigmas of the event cameras' observations of features that a frame camera follows, too: where an event
/// frame shows an edge depends on its contrast and the direction of motion, by the same amount in many images.
void inflate_correlated(std::span<CameraObservations> observations, std::span<const CameraImage> views,
                        const StereoConfig& config);

/// Ends the tracks of `to` that have left the epipolar line of the same feature in `from`.
void drop_mismatches(const CameraImage& from, const CameraImage& to, const ImuPropagator& body,
                     const StereoConfig& config);

}  // namespace edged
