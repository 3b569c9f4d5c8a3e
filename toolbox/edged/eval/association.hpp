// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pairs of true and estimated poses at the same instants.
#pragma once

#include <cstddef>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// The pose of one sensor at one instant, once as measured by the reference and once as estimated. The world frames
/// still differ.
struct PosePair {
  Timestamp t;
  SE3 truth;
  SE3 estimate;
};

struct Association {
  std::vector<PosePair> pairs;  ///< in time order
  std::size_t outside = 0;      ///< estimates before the first or after the last true pose
  std::size_t in_gaps = 0;      ///< estimates where neighbouring true poses are too far apart
  Timestamp truth_begin{};      ///< of the first true pose
};

/// No interpolation between true poses further apart than this [s].
constexpr double kDefaultMaxGap_s = 0.2;

/// The truth at the estimate's stamps: position linear, rotation slerp between the two neighbours in time.
/// Both trajectories must be in ascending time order, else InputError.
Association associate(const Trajectory& truth, const Trajectory& estimate,
                      Duration max_gap = duration_from_seconds(kDefaultMaxGap_s));

/// Pose i with pose i, for formats without stamps (KITTI). Throws InputError when the lengths differ.
Association associate_by_index(const Trajectory& truth, const Trajectory& estimate);

}  // namespace edged
