// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/report_path.hpp"

#include <algorithm>
#include <limits>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/parse/trajectory_io.hpp"

namespace edged {
namespace {

void add_truth(AlignedPath& path, const GroundTruth& truth, const OutputFrame& frame, const Association& association) {
  for (std::size_t i = 0; i < path.shown.size(); ++i) {
    const SE3 T_X_B = path.shown[i].T.inverse() * path.body[i].T;
    path.shown[i].T = path.alignment * path.shown[i].T;
    path.body[i].T = path.shown[i].T * T_X_B;
  }
  std::size_t i = 0;  // of the pose that is nearest in time
  for (const PosePair& pair : association.pairs) {
    const auto apart = [&](std::size_t k) { return std::chrono::abs(path.shown[k].t - pair.t); };
    while (i + 1 < path.shown.size() && apart(i + 1) < apart(i)) ++i;
    const SE3 estimate = path.alignment * pair.estimate;
    path.truth[i] = pair.truth;
    path.true_body[i] = frame.to_body({pair.t, pair.truth}).T;
    path.error_m[i] = (pair.truth.translation() - estimate.translation()).norm();
    path.rotation_deg[i] = kDegreesPerRadian * so3::log(pair.truth.rotation().conjugate() * estimate.rotation()).norm();
  }
  for (const StampedPose& pose : truth.trajectory) {
    if (pose.t >= path.shown.front().t && pose.t <= path.shown.back().t) path.true_path.push_back(pose);
  }
}

}  // namespace

void CausalPoses::begin_at(Timestamp since) {
  const auto first = std::ranges::lower_bound(body, since, {}, &StampedPose::t) - body.begin();
  body.erase(body.begin(), body.begin() + first);
  shown.erase(shown.begin(), shown.begin() + first);
  rows.erase(rows.begin(), rows.begin() + first);
}

CausalPoses causal_poses(const std::filesystem::path& folder, const StatesTable& states, const std::string& written,
                         const OutputFrame& shown) {
  CausalPoses poses;
  poses.body = body_poses(states, &poses.rows);
  try {
    const bool of_camera = written != "body" && shown.name() == written;
    poses.shown = of_camera ? read_tum(folder / "trajectory.tum") : shown(poses.body);
  } catch (const InputError&) {  // not in time order, as a clock was set back: not compared either
    poses.shown = shown(poses.body);
  }
  const std::size_t complete = std::min(poses.body.size(), poses.shown.size());  // a kill may come between two files
  poses.body.resize(complete);
  poses.shown.resize(complete);
  poses.rows.resize(complete);
  return poses;
}

AlignedPath align_with_truth(const CausalPoses& poses, const std::vector<StateCovarianceSample>& samples,
                             const OutputFrame& frame, const std::optional<GroundTruth>& truth,
                             const EvaluationOptions& how) {
  AlignedPath path;
  static_cast<CausalPoses&>(path) = poses;
  path.frame = frame.name();
  path.truth.resize(path.body.size());
  path.true_body.resize(path.body.size());
  path.error_m.assign(path.body.size(), std::numeric_limits<double>::quiet_NaN());
  path.rotation_deg = path.error_m;
  if (!truth || path.body.empty()) return path;
  try {
    const Association association = associate(truth->trajectory, path.shown, how);
    path.evaluation = evaluate(association, chosen_protocol(how));
    path.alignment = path.evaluation->alignment;
    add_truth(path, *truth, frame, association);
    Trajectory true_body;
    for (const StampedPose& pose : truth->trajectory) true_body.push_back(frame.to_body(pose));
    path.pose_errors = check_consistency(true_body, samples).errors;
  } catch (const InputError& e) {
    path.not_compared = e.what();
  }
  return path;
}

}  // namespace edged
