// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks of the recording and of the estimate during a run, for its verdict.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/findings.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/checks/recording_check.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

/// Samples that contradict the estimate are rejected: a few are outliers, many mean a wrong description of the sensor.
void judge_external(const OdometryCounters& counters, std::vector<Finding>& out) {
  constexpr double kFewest = 50.0, kMost = 0.3;
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    const auto used = static_cast<double>(counters.external.used[i]);
    const auto rejected = static_cast<double>(counters.external.rejected[i]);
    if (used + rejected < kFewest || rejected < kMost * (used + rejected)) continue;
    out.push_back({Severity::Warning,
                   fmt::format("{}: {:.0f} % of its samples contradict the estimate and were rejected",
                               external_sensors()[i].name, 100.0 * rejected / (used + rejected)),
                   "`edged doctor` finds wrong signs, axes and units; a larger sigma gives the sensor less weight"});
  }
}

/// Rotation and baseline of the cameras of a kind to the first one, found against given: a rig that was bent.
void judge_rig(const Rig& given, const Rig& found, const CalibrationConfig& config, std::vector<Finding>& out) {
  constexpr double kSigmas = 3.0;  // of the prior: two cameras whose views overlap estimate these far better
  for (const RigCamera& camera : found.cameras) {
    const RigCamera& first = *found.find(camera.modality);
    const bool is_told = std::any_of(found.cameras.data(), &camera, [&](const RigCamera& before) {
      return is_same_lens(given.camera(before.name), given.camera(camera.name));
    });
    if (&camera == &first || is_told) continue;
    const SE3 before = given.camera(first.name).T_B_C.inverse() * given.camera(camera.name).T_B_C;
    const SE3 now = first.T_B_C.inverse() * camera.T_B_C;
    const double turned_deg = kDegreesPerRadian * so3::log((before.inverse() * now).rotation()).norm();
    const double moved_mm = 1e3 * (now.translation() - before.translation()).norm();
    const bool is_bent =
        turned_deg > kSigmas * config.relative_rotation_sigma_deg || moved_mm > kSigmas * config.baseline_sigma_mm;
    if (!is_bent || config.relative_rotation_sigma_deg == 0.0 || config.baseline_sigma_mm == 0.0) continue;
    out.push_back(
        {Severity::Warning,
         fmt::format("cameras {} and {}: their pose to each other is {:.2f} deg and {:.1f} mm off the calibration",
                     first.name, camera.name, turned_deg, moved_mm),
         "the rig may be bent; the run has corrected it; pass calibration_found.yaml of this run with --calib, or "
         "calibrate again"});
  }
}

/// Contradictions are reported as soon as they are known, so that the user can stop the run.
class RunChecks : public RunObserver {
 public:
  explicit RunChecks(RunContext& run)
      : run_(run),
        check_(run.info(),
               CheckedCalibration{run.used.cameras, run.source.calibration.has_extrinsics,
                                  run.source.calibration.known_noise()},
               RecordingCheck::Effort::DuringRun) {}

  void on_measurement(const Measurement& measurement) override {
    const auto timer = run_.timings.measure_often("check");
    check_.add(measurement);
    for (const Finding& finding : check_.news()) spdlog::error(fmt::format("{}: {}", finding.text, finding.remedy));
  }

  void on_summary(RunEnd& end) override {
    RunSummary& summary = end.summary;
    const CalibrationConfig& config = run_.config.odometry.estimator.calibration;
    const Rig& given = run_.source.calibration.rig;
    summary.calibration = compare_calibrations(given, run_.rig, end.covariances, config);
    const bool dropped_frames = summary.live && summary.live->dropped.frames > 0;
    for (Finding& finding : check_.findings(*run_.source.dataset, end.truth, dropped_frames))
      summary.verdict.findings.push_back(std::move(finding));
    judge_external(end.counters, summary.verdict.findings);
    if (!has_error(summary.verdict.findings)) judge_rig(given, run_.rig, config, summary.verdict.findings);
    for (CalibrationFound& found : summary.calibration)
      found.beyond = found.beyond && !check_.agrees_with(run_.rig.camera(found.camera));
  }

 private:
  RunContext& run_;
  RecordingCheck check_;
};

}  // namespace

RunOutput checks_output() { return always<RunChecks>(); }

}  // namespace edged
