// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The joint optimization after a run: all keyframes of a start of the estimator with all their measurements, and the
// map matches between them.
#pragma once

#include <vector>

#include "edged/estimator/window/start_record.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/map/trajectory/trajectory_smoother.hpp"

namespace edged {

/// Half the sum of the squared residuals, with their losses, before and after.
struct FinalCost {
  double before = 0.0, after = 0.0;
};

/// The poses T_M_B of all keyframes of all starts, in order of time: one start after the other, in the map of those
/// before it and of a loaded map. `solution` has the initial values; its keyframes are replaced by the new ones.
/// A start whose cost is not defined at the initial values has none. Deterministic.
Trajectory optimize_jointly(const TrajectorySmoother& record, std::vector<StartRecord> starts,
                            TrajectorySmoother::Solution& solution, FinalCost& cost,
                            const OptimizationProgress& progress = {});

}  // namespace edged
