// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The poses of a run or a trajectory file as its report shows them: laid onto the truth where there is one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/dataset.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/io/calibration.hpp"
#include "report/evaluation.hpp"

namespace edged {

struct ReportPath {
  std::string frame = "body";                 ///< whose pose `shown` is
  Trajectory shown;                           ///< in the world of the truth, else in that of the estimate
  Trajectory body;                            ///< the same of the body, on the IMU clock
  std::vector<std::size_t> rows;              ///< of states.csv, one for each pose
  std::vector<std::optional<SE3>> truth;      ///< true pose, one for each pose; of a sparse truth, at the nearest one
  std::vector<std::optional<SE3>> true_body;  ///< the same of the body
  Trajectory true_path;                       ///< all of the truth while the run lasted
  std::vector<double> error_m, rotation_deg;  ///< one for each pose, NaN where there is no truth
  std::vector<PoseErrorSample> pose_errors;   ///< errors since each start, and how large they may be
  std::optional<Evaluation> evaluation;       ///< nothing where there is no truth, or it does not fit
  std::string not_compared;                   ///< why, where there is a truth
  Similarity alignment;                       ///< world of the estimate to the world that is shown
};

/// body: T_W_B. frame: whose pose is shown where there is no truth, which brings its own. samples: none of a file.
ReportPath lay_onto_truth(const Trajectory& body, const std::vector<PoseCovarianceSample>& samples, const Rig& rig,
                          const std::string& frame, const std::optional<GroundTruth>& truth,
                          const EvaluationOptions& how);

}  // namespace edged
