// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges two maps of one place from independent runs.
#pragma once

#include <optional>
#include <string>

#include "edged/map/saved_map.hpp"

namespace edged {

struct MapAlignment {
  std::optional<SE3> T_A_B;  ///< the frame B of the other map in the frame A of the map
  std::string refusal;       ///< why there is none, with the numbers that are nearest: a clause
};

/// From keyframes of `other` recognized in `map` by descriptors; only where several agree.
MapAlignment find_map_in(const SavedMap& map, const SavedMap& other);

/// Both in the frame of `map`, `other` older. The covariance contains the uncertainty of T_A_B, so that a later run in
/// both refines it.
SavedMap merged(const SavedMap& map, const SavedMap& other, const SE3& T_A_B);

}  // namespace edged
