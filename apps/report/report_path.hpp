// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The poses of a run or a trajectory file in its report: aligned with the truth if there is one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/output_frame.hpp"
#include "edged/dataset.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "report/evaluation.hpp"
#include "report/states_table.hpp"

namespace edged {

/// The causal trajectory of a run.
struct CausalPoses {
  Trajectory body, shown;         ///< T_W_B, and of the sensor that is evaluated
  std::vector<std::size_t> rows;  ///< of states.csv, one for each pose

  /// Leaves out what is before, on the IMU clock.
  void begin_at(Timestamp since);
};

/// From trajectory.tum, as each was published; of another sensor than that of the file, from states.csv by its frame.
CausalPoses causal_poses(const std::filesystem::path& folder, const StatesTable& states, const std::string& written,
                         const OutputFrame& shown);

/// Those, in the world of the truth if there is one.
struct AlignedPath : CausalPoses {
  std::string frame = "body";                 ///< whose pose `shown` is
  std::vector<std::optional<SE3>> truth;      ///< true pose, one for each pose; of a sparse truth, at the nearest one
  std::vector<std::optional<SE3>> true_body;  ///< `truth` of the body
  Trajectory true_path;                       ///< the ground truth over the time of the run
  std::vector<double> error_m, rotation_deg;  ///< one for each pose, NaN where there is no truth
  std::vector<PoseErrorSample> pose_errors;   ///< errors since each start, and their limits
  std::optional<Evaluation> evaluation;       ///< nothing where there is no truth, or it does not fit
  std::string not_compared;                   ///< the reason, if there is a truth
  Similarity alignment;                       ///< world of the estimate to the world that is shown
};

/// frame: that of `shown`, by which the truth becomes that of the body. samples: empty for a file.
AlignedPath align_with_truth(const CausalPoses& poses, const std::vector<StateCovarianceSample>& samples,
                             const OutputFrame& frame, const std::optional<GroundTruth>& truth,
                             const EvaluationOptions& how);

}  // namespace edged
