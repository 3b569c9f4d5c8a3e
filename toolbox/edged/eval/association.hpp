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
  std::size_t in_gaps = 0;      ///< poses of the sparser where those in the denser are too far from it, or apart
  Timestamp estimate_begin{};   ///< stamp of the first estimated pose
};

/// No interpolation between true poses further apart than this [s].
constexpr double kDefaultMaxGap_s = 0.2;

/// Median time between neighbours; Duration::max() where there are none.
Duration typical_step(const Trajectory& trajectory);

/// The pose at t: position linear, rotation slerp.
SE3 interpolated(const StampedPose& before, const StampedPose& after, Timestamp t);

enum class Matching {
  Interpolate,  ///< the denser trajectory, at the stamp
  Nearest,      ///< its nearest pose within 10 ms, as evo does: in motion the time between the two is an error
};

/// Both at the stamps of the sparser one, for which the denser one is interpolated: between poses that are far apart a
/// motion is no line. Both trajectories must be in ascending time order, else InputError.
Association associate(const Trajectory& truth, const Trajectory& estimate,
                      Duration max_gap = duration_from_seconds(kDefaultMaxGap_s),
                      Matching matching = Matching::Interpolate);

/// Pose i with pose i, for formats without stamps (KITTI). Throws InputError when the lengths differ.
Association associate_by_index(const Trajectory& truth, const Trajectory& estimate);

}  // namespace edged
