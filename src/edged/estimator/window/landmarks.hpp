// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The life of landmarks: triangulation from tracks, outlier rejection after each solve, move to a new anchor.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "edged/estimator/window/window.hpp"
#include "edged/options/estimator.hpp"

namespace edged {

enum class Tracks { Alive, All };

/// Whether the gyroscope measured all rotation within the window: it was never beyond its range.
bool rotation_measured(const Window& window);

/// Turns tracks that have enough parallax into landmarks, within the budget of each camera: those of live tracks, and
/// at an initialization in motion also those of ended tracks, which its first views have observed.
void triangulate_features(Window& window, const LandmarkConfig& config, Tracks tracks = Tracks::Alive);

/// Removes observations of the newest state that are far from their prediction by its predicted pose: they are on a
/// dynamic object, or wrong. If these are most observations of a camera, the prediction is assumed wrong instead.
/// Returns the features: their tracks should end.
std::vector<FeatureId> reject_unexpected(Window& window);

/// Removes observations that do not fit the solved window, and landmarks whose residuals over all views are larger than
/// those of the rest of the scene: those of dynamic objects are a little too large everywhere. Returns the features
/// whose newest observation was removed: their tracks are outliers and should end.
std::vector<FeatureId> remove_outliers(Window& window, const LandmarkConfig& config);

enum class Newness { Newest, Any };

/// Spread of the innovations of one camera's observations, in the newest state or in any, given the observation before
/// (track_steps): the standard deviation of one coordinate by the median length, in sigmas; nothing with too few of
/// them.
std::optional<double> median_residual(const Window& window, std::size_t camera, Newness newness = Newness::Newest);

/// The inverse depth of a point in O if it were anchored in a view [1/m]; nothing outside the depth bounds.
std::optional<double> inverse_depth_in(const Window& window, const ObservationKey& view, const Eigen::Vector3d& p_O,
                                       const LandmarkConfig& config);

/// Removes observations of landmarks that are not in front of the camera, where the cost is not defined, and landmarks
/// without another observation.
void remove_hidden(Window& window);

/// Calls Window::predict for each observation of a landmark where that is due.
void predict_observations(Window& window);

}  // namespace edged
