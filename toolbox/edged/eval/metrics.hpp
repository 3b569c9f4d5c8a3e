// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Absolute and relative errors of an estimate under a named protocol.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/eval/alignment.hpp"

namespace edged {

/// Statistics of one error over all pairs. std is that of the population; the median of an even number is the middle
/// two's mean.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0, mean = 0, median = 0, std = 0, min = 0, max = 0, sse = 0;
};
Statistics statistics(std::vector<double> errors);

/// Which alignment on which part of the trajectory; the errors are always over all pairs.
struct Protocol {
  std::string name;
  AlignmentKind alignment = AlignmentKind::SE3;
  TimeWindow window;
};

/// The protocols the literature uses: "P1" SE(3) on seconds 3-8 (Ultimate SLAM), "P2" SE(3) on the first 5 s
/// (PL-EVIO, EVI-SAM), "P3" SE(3) on all (ESVIO), "P4" Sim(3) on all (DEVO). Throws InputError for another name.
Protocol protocol(std::string_view name);

/// Error of the motion over delta_s, after the alignment's scale.
struct RelativeError {
  double delta_s = 0.0;
  Statistics translation_m;
  Statistics rotation_deg;
};

/// Pair i against the first pair at least delta_s later (and at most 10 % more than that): the motion between them,
/// true against estimated. Every i counts.
RelativeError relative_error(const std::vector<PosePair>& pairs, double delta_s);

/// Local error: the ATE of windows of window_s that are each aligned by themselves.
struct LocalError {
  double window_s = 0.0;
  std::size_t windows = 0;
  double rmse_m = 0.0;  ///< over the windows; NaN where there is none
};

/// The windows for the comparison of variants.
constexpr std::array<double, 3> kLocalWindows_s = {1.0, 3.0, 10.0};

/// RMS over all windows [s, s + window_s), a quarter of a window apart, of the RMS position error after SE(3) alignment
/// of the window alone. The first begins 4 s after the first estimated pose (or with the first pair, if that is later),
/// the last ends before the last pair. Windows of 10 pairs or fewer do not count.
LocalError local_error(const Association& association, double window_s);

/// [m] Of a shorter path no share means anything: then errors per path length and scale are NaN.
inline constexpr double kShortestPath_m = 0.5;

struct Evaluation {
  Protocol protocol;
  std::size_t pairs = 0, outside = 0, in_gaps = 0;
  double duration_s = 0.0;     ///< first to last pair; NaN without times
  double path_length_m = 0.0;  ///< along the true poses at the pairs
  Similarity alignment;        ///< what was applied to the estimate
  double scale = 1.0;  ///< Sim(3) scale over all pairs, whatever the protocol: 1 is perfect, truth = scale * estimate
  double start_scale = 1.0;         ///< Sim(3) scale over the first 5 s of the estimate; NaN with too little motion
  double first_scale = 1.0;         ///< extent of the truth over that of the estimate in its first 2 s; NaN as above
  double later_scale = 1.0;         ///< that extent ratio ten seconds later
  Statistics ate_m;                 ///< position error
  Statistics rotation_deg;          ///< angle between true and aligned rotation
  Statistics yaw_deg;               ///< size of its part about the world's z
  Statistics tilt_deg;              ///< angle of up before alignment, which hides it; the truth must be level
  double mpe_percent = 0.0;         ///< mean position error / path length
  double rotation_deg_per_m = 0.0;  ///< mean rotation error / path length
  double yaw_deg_per_m = 0.0;       ///< mean yaw error / path length
  std::vector<RelativeError> relative;  ///< one per requested delta
  std::vector<LocalError> local;        ///< one per requested window, whatever the protocol
};

/// Both trajectories must be of the same sensor on the same clock (or pairs made by index). Throws InputError when
/// nothing overlaps or the alignment is not possible.
Evaluation evaluate(const Association& association, const Protocol& protocol,
                    const std::vector<double>& deltas_s = {1.0, 10.0},
                    std::span<const double> local_windows_s = kLocalWindows_s);

}  // namespace edged
