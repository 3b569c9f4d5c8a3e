// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_check.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numbers>

#include "edged/core/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr double kLeastRate = 0.15;                              // what counts as turning [rad/s]
constexpr Duration kFirstLook = std::chrono::seconds(2);         // turning for so long, a camera can be judged
constexpr double kUnexplained = 0.5;                             // beyond it an agreement means little
constexpr double kSureOfRotation = 0.5 * std::numbers::pi / 180; // [rad]
constexpr Duration kFirstUnits = std::chrono::seconds(5);        // until then a gyro can be checked against a camera

bool agrees(const std::optional<GyroAgreement>& found) { return found && found->unexplained < kUnexplained; }

/// Up to its numbers.
std::string subject_of(const Finding& finding) { return finding.text.substr(0, finding.text.find(':')); }

void judge_lever_arm(const RigCamera& camera, std::vector<Finding>& out) {
  constexpr double kLongest_m = 2.0;
  const double arm_m = camera.T_B_C.translation().norm();
  if (arm_m <= kLongest_m) return;
  out.push_back({Severity::Error,
                 fmt::format("camera {}: calibrated {:.4g} m away from the IMU, as if its translation were in millimetres",
                             camera.name, arm_m),
                 "translations are in metres: divide that of T_B_C by 1000"});
}

}  // namespace

RunCheck::RunCheck(const DatasetInfo& info, const Calibration& calibration, Mode mode)
    : has_extrinsics_(calibration.has_extrinsics), mode_(mode), surveyor_(info) {
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    if (mode == (modality == Modality::Events ? Mode::Frames : Mode::Events)) continue;
    const RigCamera& camera = *calibration.rig.find(modality);
    cameras_.push_back({camera, VisualTurns(camera)});
    cameras_.back().next_look = kFirstLook;
  }
}

void RunCheck::add(const Measurement& measurement) {
  surveyor_.add(measurement);
  const auto first = first_stamp(measurement), last = last_stamp(measurement);
  if (!first) return;
  const auto note = [&](std::optional<Timestamp>& begin, Duration& length) {
    if (!begin) begin = first;
    length = *last - *begin;
  };
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    note(first_imu_, imu_);
    if (std::ranges::all_of(cameras_, &Camera::done)) return;
    gyro_.add(*sample);
    ImuSample mirrored = *sample;
    mirrored.gyro_B *= -1.0;
    mirrored_gyro_.add(mirrored);
  } else {
    note(first_visual_, visual_);
    for (Camera& camera : cameras_) follow(camera, measurement);
  }
  if (!looked_ && std::min(imu_, visual_) >= kFirstUnits) look_ = true;
}

void RunCheck::follow(Camera& camera, const Measurement& measurement) {
  if (camera.done) return;
  camera.visual.add(measurement);
  const std::vector<Turn>& turns = camera.visual.turns();
  for (; camera.counted < turns.size(); ++camera.counted) {
    const Turn& turn = turns[camera.counted];
    const Timestamp before = camera.counted == 0 ? turn.begin : std::max(turn.begin, turns[camera.counted - 1].end);
    if (turn.phi_C.norm() > kLeastRate * to_seconds(turn.end - turn.begin)) camera.turning += turn.end - before;
  }
  if (camera.turning < camera.next_look) return;
  camera.next_look = 2 * camera.turning;
  compare(camera);
  look_ = true;
}

/// What is not sure yet is looked at again.
void RunCheck::compare(Camera& camera) {
  const std::vector<Turn>& turns = camera.visual.turns();
  camera.agreement = compare_with_gyro(turns, gyro_, camera.given.time_offset);
  camera.mirrored =
      !agrees(camera.agreement) && agrees(compare_with_gyro(turns, mirrored_gyro_, camera.given.time_offset));
  camera.done = camera.mirrored || (agrees(camera.agreement) && camera.agreement->rotation_sigma < kSureOfRotation);
}

std::vector<Finding> RunCheck::judge(Survey survey) const {
  // A gap is bridged, counted among the repairs, and known to the estimate's covariance.
  survey.imu.gaps = 0;
  std::vector<CameraCheck> checks;
  for (const Camera& camera : cameras_) checks.push_back({camera.given, has_extrinsics_, camera.agreement});
  std::vector<Finding> out = diagnose(survey, true, checks);
  for (const Camera& camera : cameras_) {
    const bool events = camera.given.modality == Modality::Events;
    const std::string kind = events ? "events" : "frames";
    if ((events ? survey.events : survey.frames).count == 0)
      out.push_back({Severity::Error, fmt::format("no {}: the mode needs them, and not one came", kind),
                     fmt::format("record them, name their topic with --topic {}=NAME, or choose another --mode", kind)});
    if (camera.mirrored)
      out.push_back({Severity::Error,
                     fmt::format("camera {}: turns as the gyro says only if the IMU's axes are mirrored: one of them, or "
                                 "all three, have the wrong sign",
                                 camera.given.name),
                     "give gyro and accelerometer in the same right-handed axes"});
    judge_lever_arm(camera.given, out);
  }
  std::erase_if(out, [](const Finding& f) { return f.severity == Severity::Good || f.severity == Severity::Note; });
  return out;
}

std::vector<Finding> RunCheck::news() {
  if (!std::exchange(look_, false)) return {};
  looked_ = true;
  std::vector<Finding> fresh = judge(surveyor_.so_far());
  std::erase_if(fresh, [this](const Finding& finding) {
    const bool known = std::ranges::find(told_, subject_of(finding)) != told_.end();
    return known || finding.severity != Severity::Error;
  });
  for (const Finding& finding : fresh) told_.push_back(subject_of(finding));
  return fresh;
}

std::vector<Finding> RunCheck::findings(const Dataset& dataset) {
  for (Camera& camera : cameras_)
    if (!camera.done) compare(camera);
  return judge(surveyor_.result(dataset));
}

}  // namespace edged
