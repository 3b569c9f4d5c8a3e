// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Searches images for what the map has: its points where they should be in view, and its places by their appearance.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/keyframe_map.hpp"
#include "edged/map/map_filter.hpp"
#include "edged/map/places/place.hpp"
#include "edged/options/map.hpp"
#include "edged/pipeline/vision/tracked_image.hpp"

namespace edged {

/// Points that should be in view, and their matches, in those images of one instant where enough of them match.
struct MapSearch {
  std::vector<Candidate> candidates;
  std::vector<SE3> T_B_C;  ///< one per image

  std::vector<MapObservation> observations() const;
  /// How many points of keyframes before t were matched.
  std::ptrdiff_t matched_before(const KeyframeMap& map, Timestamp t) const;
};

/// Matches the points of keyframes of that time. Those keyframes of the filter become active.
MapSearch search_map(KeyframeMap& map, MapFilter& filter, const MapConfig& config, const SE3& T_M_O,
                     std::span<const PosedImage> images, TimeInterval created);

/// One of each per track; points: on the unit plane.
struct ImageFeatures {
  std::vector<std::optional<Descriptor>> descriptors;
  std::vector<Eigen::Vector2d> points;
};
ImageFeatures features_of(const PosedImage& posed);

/// Place recognition by those features of the image.
Recognition recognize_place(const KeyframeMap& map, const MapQuery& query, const ImageFeatures& features,
                            const PosedImage& posed);

/// The filter with the body at a recognized place, to be confirmed.
MapFilter filter_at(const MapFilter& filter, const SE3& T_M_O, const SE3& T_O_B, Timestamp t);

}  // namespace edged
