// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/report_path.hpp"

#include <limits>

#include "edged/camera/output_frame.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

void add_truth(AlignedPath& path, const GroundTruth& truth, const OutputFrame& frame, const Association& association) {
  for (std::size_t i = 0; i < path.shown.size(); ++i) {
    path.shown[i].T = path.alignment * path.shown[i].T;
    path.body[i].T = frame.to_body(path.shown[i]).T;
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

Rig rig_for_poses(const Rig& given, Rig found) {
  for (RigCamera& camera : found.cameras)
    if (camera.modality == Modality::Events) camera.time_offset = given.camera(camera.name).time_offset;
  return found;
}

AlignedPath align_with_truth(const Trajectory& body, const std::vector<StateCovarianceSample>& samples, const Rig& rig,
                             const std::string& frame_name, const std::optional<GroundTruth>& truth,
                             const EvaluationOptions& how) {
  AlignedPath path;
  const OutputFrame frame(rig, truth ? truth->frame : frame_name);
  path.frame = frame.name();
  path.body = body;
  path.shown = frame(body);
  path.truth.resize(body.size());
  path.true_body.resize(body.size());
  path.error_m.assign(body.size(), std::numeric_limits<double>::quiet_NaN());
  path.rotation_deg = path.error_m;
  if (!truth || body.empty()) return path;
  try {
    const Association association = associate(truth->trajectory, path.shown, duration_from_seconds(how.max_gap_s));
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
