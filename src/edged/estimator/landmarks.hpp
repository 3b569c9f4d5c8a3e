// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The life of landmarks: triangulated from tracks, judged after each solve, moved to a younger anchor.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "edged/estimator/window.hpp"
#include "edged/options/estimator.hpp"

namespace edged {

enum class Tracks { Alive, All };

/// Turns tracks that have enough parallax into landmarks, within the budget of each camera: those that go on, or at a
/// start in motion also those that have ended, as they are what its first views have seen.
void triangulate_features(Window& window, const LandmarkConfig& config, Tracks tracks = Tracks::Alive);

/// Takes out what the newest state sees of landmarks far from where its predicted pose expects them: on something that
/// moves, or wrong. Where that is most of what a camera sees, the prediction is doubted instead. Returns the features:
/// their tracks should end.
std::vector<FeatureId> reject_unexpected(Window& window, const LandmarkConfig& config);

/// Takes out observations that do not fit the solved window, and landmarks that over all their views fit worse than the
/// rest of the scene: what moves by itself bends a little everywhere. Returns the features whose newest observation was
/// taken out: their tracks are wrong and should end.
std::vector<FeatureId> remove_outliers(Window& window, const LandmarkConfig& config);

enum class Newness { Newest, Any };

/// Spread of what one camera's observations, in the newest state or in any, are off by beyond what the observation
/// before tells (track_steps): the standard deviation of one coordinate by the median length, in sigmas; nothing with
/// too few of them.
std::optional<double> median_residual(const Window& window, std::size_t camera, Newness newness = Newness::Newest);

/// The inverse depth at which a point of the world would be anchored in a view [1/m]; nothing
/// out of the depth bounds.
std::optional<double> inverse_depth_in(const Window& window, const ObservationKey& view, const Eigen::Vector3d& p_O,
                                       const LandmarkConfig& config);

}  // namespace edged
