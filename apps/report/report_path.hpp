// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The poses of a run or a trajectory file in its report: aligned with the truth if there is one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/io/calibration.hpp"
#include "report/evaluation.hpp"

namespace edged {

struct AlignedPath {
  std::string frame = "body";                 ///< whose pose `shown` is
  Trajectory shown;                           ///< in the world of the truth, else in that of the estimate
  Trajectory body;                            ///< `shown` of the body, on the IMU clock
  std::vector<std::size_t> rows;              ///< of states.csv, one for each pose
  std::vector<std::optional<SE3>> truth;      ///< true pose, one for each pose; of a sparse truth, at the nearest one
  std::vector<std::optional<SE3>> true_body;  ///< `truth` of the body
  Trajectory true_path;                       ///< the ground truth over the time of the run
  std::vector<double> error_m, rotation_deg;  ///< one for each pose, NaN where there is no truth
  std::vector<PoseErrorSample> pose_errors;   ///< errors since each start, and their limits
  std::optional<Evaluation> evaluation;       ///< nothing where there is no truth, or it does not fit
  std::string not_compared;                   ///< the reason, if there is a truth
  Similarity alignment;                       ///< world of the estimate to the world that is shown
};

/// The rig by which poses of its cameras are those of the body: as found by the run. The time offset found for an event
/// camera contains the latency of its pixels, which no pose has: the given one.
Rig rig_for_poses(const Rig& given, Rig found);

/// body: T_W_B. rig: as of rig_for_poses. frame: whose pose is shown without a truth, which has its own frame. samples:
/// empty for a file.
AlignedPath align_with_truth(const Trajectory& body, const std::vector<StateCovarianceSample>& samples, const Rig& rig,
                             const std::string& frame, const std::optional<GroundTruth>& truth,
                             const EvaluationOptions& how);

}  // namespace edged
