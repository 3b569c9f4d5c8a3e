// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Two maps of one place, made by runs that knew nothing of one another, as one.
#pragma once

#include <optional>

#include "edged/map/saved_map.hpp"

namespace edged {

/// Where the frame B of `other` lies in the frame A of `map`, by keyframes of the one whose place is recognized in the
/// other by its looks: T_A_B. Nothing unless several agree.
std::optional<SE3> find_map_in(const SavedMap& map, const SavedMap& other);

/// Both in the frame of `map`, `other` older. How well T_A_B is known is in the covariance, so that a run in both pulls
/// them together.
SavedMap merged(const SavedMap& map, const SavedMap& other, const SE3& T_A_B);

}  // namespace edged
