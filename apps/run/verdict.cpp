// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/verdict.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/counted.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/checks/run_check.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/estimator/window/calibration_prior.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

/// An estimate is a finding only if the calibration error exceeds the uncertainty of the estimate.
void judge_calibration(const CalibrationFound& c, std::vector<Finding>& out) {
  constexpr double kSigmas = 3.0, kLeast_deg = 1.0, kLeast_ms = 5.0;  // smaller errors are harmless
  constexpr double kMostLatency_ms = 15.0;
  const double shift_ms = c.time_offset_ms - c.given_offset_ms;
  const Severity severity = c.beyond ? Severity::Error : Severity::Warning;
  const std::string done = c.beyond ? "more than a run can correct" : "the run has corrected it";
  if (c.inverse)
    out.push_back({severity,
                   fmt::format("camera {}: its rotation to the IMU was estimated {:.2f} deg +- {:.2f} deg off the "
                               "calibration, the inverse fits",
                               c.camera, c.rotation_deg, *c.rotation_sigma_deg),
                   kTurnRound});
  else if (c.rotation_sigma_deg && c.rotation_deg > std::max(kLeast_deg, kSigmas * *c.rotation_sigma_deg))
    out.push_back({severity,
                   fmt::format("camera {}: its rotation to the IMU is {:.2f} deg +- {:.2f} deg off the calibration",
                               c.camera, c.rotation_deg, *c.rotation_sigma_deg),
                   done + "; calibrate camera and IMU anew"});
  // In dim light the pixels of an event camera answer late: an estimate takes that for its clock, rightly.
  const bool latency = c.events && shift_ms < 0.0 && shift_ms > -kMostLatency_ms;
  if (c.time_sigma_ms && !latency && std::abs(shift_ms) > std::max(kLeast_ms, kSigmas * *c.time_sigma_ms))
    out.push_back({severity,
                   fmt::format("camera {}: t_imu = t_cam {:+.2f} ms +- {:.2f} ms was estimated, {:+.2f} ms is given",
                               c.camera, c.time_offset_ms, *c.time_sigma_ms, c.given_offset_ms),
                   fmt::format("{}; set time_offset of this camera to {:.4f}", done, 1e-3 * c.time_offset_ms)});
}

/// "0.0123 +- 0.0012" of a share, "12.3 +- 1.1 mm" of a length: by the unit at the end of its name.
std::string amount(const CorrectionFound& c) {
  const std::string unit = c.name.ends_with("_mm") ? " mm" : c.name.ends_with("_px") ? " px" : " %";
  if (c.name.find('_') == std::string::npos) return fmt::format("{:+.4f} +- {:.4f}", c.off, c.sigma);
  return fmt::format("{:+.2f} +- {:.2f}{}", c.off, c.sigma, unit);
}

/// Lens and position beyond three sigma of what is given and of the estimate. A run corrects them, but begins wrong.
void judge_lens_and_position(const CalibrationFound& c, std::vector<Finding>& out) {
  std::string list;
  for (const CorrectionFound& number : c.corrections) {
    if (!number.beyond()) continue;
    const std::string what = number.name.substr(0, number.name.find('_'));
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", what, amount(number));
  }
  if (list.empty()) return;
  out.push_back({Severity::Warning, fmt::format("camera {}: differs from the calibration by {}", c.camera, list),
                 "the run has corrected it; pass calibration_found.yaml of this run with --calib, or calibrate anew"});
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
         "calibrate anew"});
  }
}

/// Calibrations are accurate to a degree: smaller rotations do not determine the direction. The inverse must be far
/// closer.
bool fits_inverse(const SE3& given, const SE3& found, double found_deg, double sigma_deg) {
  constexpr double kLeast_deg = 1.0, kSigmas = 4.0, kNearer = 0.4;
  const double inverse_deg = kDegreesPerRadian * so3::log(given.rotation() * found.rotation()).norm();
  return found_deg > std::max(kLeast_deg, kSigmas * sigma_deg) && inverse_deg < kNearer * found_deg;
}

/// Inconsistencies appear in the biases first.
void judge_biases(const RunStatistics& run, std::vector<Finding>& out) {
  constexpr double kMost = 1.2;  // [m/s^2]; up to 0.5 on the mirror recordings
  if (run.accel_bias().norm() > kMost)
    out.push_back({Severity::Error,
                   fmt::format("accelerometer: a bias of {:.1f} m/s^2 was estimated, more than such sensors have",
                               run.accel_bias().norm()),
                   "check its axes, scale and unit, and the pose of the cameras to it"});
}

/// With --localize-only a loss is silence: no pose depends on dead reckoning.
void judge_losses(const RunStatistics& run, bool localize_only, std::vector<Finding>& out) {
  constexpr double kMostLost = 0.1;
  const Severity severe = localize_only ? Severity::Warning : Severity::Error;
  const double lost_s = run.time_in_s(TrackingStatus::Lost);
  const std::string why = run.lost_because().empty() ? "" : ", the last time as " + run.lost_because();
  const std::string remedy =
      localize_only ? "there are no poses while the body is not localized in the map: see states.csv and run.log"
                    : "after a loss position and yaw are those of dead reckoning: see states.csv and run.log";
  if (run.last_status() == TrackingStatus::Lost)
    out.push_back({severe, fmt::format("lost at the end{}", why), remedy});
  else if (run.lost_share() > kMostLost)
    out.push_back({severe,
                   fmt::format("lost for {:.1f} s, {:.0f} % of the time{}", lost_s, 100 * run.lost_share(), why),
                   remedy});
  else if (run.times_lost() > 0) {
    const std::string lost = fmt::format("lost {}, for {:.1f} s{}", counted(run.times_lost(), "time"), lost_s, why);
    if (run.times_contradicted() > 0)
      out.push_back({severe, lost, "the last poses before a contradiction are wrong: see states.csv and run.log"});
    else
      out.push_back({Severity::Warning, lost, remedy});
  }
}

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

/// Latency of the results, and the share of dropped events.
void judge_live(const LiveSummary& live, const RunStatistics& run, std::vector<Finding>& out) {
  constexpr double kSome = 0.1, kMost = 0.5, kLate = 4.0;
  const double dropped =
      run.events() > 0 || live.shed.events > 0
          ? static_cast<double>(live.shed.events) / static_cast<double>(live.shed.events + run.events())
          : 0.0;
  const double late_s = live.latency.quantile_s(0.50);
  const bool too_late = late_s > kLate * live.max_age_s;
  if (dropped < kSome && !too_late) return;
  out.push_back(
      {dropped > kMost || too_late ? Severity::Error : Severity::Warning,
       fmt::format("live: too slow for this recording: {:.0f} % of the events dropped, latency {:.2f} s "
                   "(median; live.max_age_s {:g})",
                   100 * dropped, late_s, live.max_age_s),
       "raise packets.min_interval_s, lower tracker.detector.max_features, choose another --mode, or use a faster "
       "computer"});
}

/// An offset between the stamps explains the other contradictions.
void judge_against_truth(const RunSummary& s, std::vector<Finding>& out) {
  constexpr double kMostOutside = 0.5, kGrossNees = 140.0;
  constexpr double kLeast_percent = 1.0;  // of the path: a smaller error is of use although its covariance is wrong
  if (s.truth_offset && s.truth_offset->matters()) {
    const TimeOffset& offset = *s.truth_offset;
    out.push_back(
        {Severity::Warning,
         fmt::format("ground truth: its stamps are {:.1f} ms {}: with that offset the ATE is {:.2f} mm, as given "
                     "{:.2f} mm",
                     1e3 * std::abs(offset.offset_s), offset.offset_s > 0 ? "late" : "early", 1e3 * offset.ate_rmse_m,
                     1e3 * offset.ate_given_m),
         fmt::format("add {:.4f} s to its stamps; `edged eval` takes the file as it is", -offset.offset_s)});
  } else if (s.consistency && s.consistency->silent_s() > 0.0) {
    const Consistency& c = *s.consistency;
    const double path_m = std::max(s.evaluation->path_length_m, kShortestPath_m);
    const bool gross = 100.0 * s.evaluation->ate_m.mean > kLeast_percent * path_m &&
                       (c.silent_s() > kMostOutside * s.evaluation->duration_s ||
                        std::max(c.position.max_nees, c.rotation.max_nees) > kGrossNees);
    out.push_back(
        {gross ? Severity::Error : Severity::Warning,
         fmt::format("ground truth: the estimate is outside 3 sigma of its covariance for {:.1f} s", c.silent_s()),
         "its errors are larger than its covariance: see `error since the start` in report.html"});
  }
}

/// If the cameras start after the chosen piece, that is the only finding.
void judge_no_start(const RunStatistics& statistics, const SourceOptions& source, Ending ending, Verdict& verdict) {
  if (ending == Ending::Complete && statistics.visual_span_s() <= 0.0) {
    if (const std::optional<double> start_s = cameras_start_after_s(source)) {
      verdict.findings = {cameras_start_later(*start_s)};
      verdict.contradicted = false;
      SourceOptions later = source;
      later.piece.from_s = later_start_s(*start_s);
      later.piece.to_s.reset();
      verdict.next = command_line("run", later);
      verdict.waiting_for.clear();
      return;
    }
  }
  verdict.next = command_line("doctor", source);
  const std::string why = statistics.packets() == 0     ? "not one packet had IMU samples around it"
                          : verdict.waiting_for.empty() ? "no start was tried"
                                                        : "it waited for " + verdict.waiting_for;
  const std::optional<double> tilt_deg = statistics.tilt_sigma_deg();
  const std::string attitude =
      tilt_deg ? fmt::format("; the attitude is in states.csv, tilt to {:.1f} deg, heading since the start", *tilt_deg)
               : "";
  verdict.findings.push_back(
      {Severity::Error, "never good: " + why + attitude, "check recording and calibration: " + verdict.next});
}

std::string status_of(const RunStatistics& statistics, const Verdict& verdict, Ending ending) {
  if (ending == Ending::BrokenOff) return "broken off";
  if (ending == Ending::Interrupted) return "interrupted";
  if (!statistics.first_good_s()) return "never good";
  if (verdict.contradicted && is_tracking(statistics.last_status())) return "not to be trusted";
  switch (statistics.last_status()) {
    case TrackingStatus::Good:
      return "good";
    case TrackingStatus::Degraded:
      return "degraded";
    case TrackingStatus::Lost:
      return "lost";
    case TrackingStatus::Initializing:
      return "lost, initializing again";
  }
  EDGED_CHECK(false, "status {}", static_cast<int>(statistics.last_status()));
}

std::string text_of(const RunSummary& s, Ending ending) {
  const Verdict& verdict = s.verdict;
  const auto error = std::ranges::find(verdict.findings, Severity::Error, &Finding::severity);
  if (ending == Ending::BrokenOff) return "an error ended the run; the results up to then are complete";
  if (ending == Ending::Interrupted) return "the run was interrupted; the results up to then are complete";
  if (verdict.contradicted) return "the result is not to be trusted: " + error->text;
  if (!verdict.trusted) return error->text.starts_with(s.status) ? error->text : s.status + ": " + error->text;
  if (s.status != "good") return "nothing contradicts the result, but it ends " + s.status;
  if (verdict.findings.empty()) return "nothing contradicts the result";
  return "nothing contradicts the result, but note: " + verdict.findings.front().text;
}

/// Contradictions are reported as soon as they are known, so that the user can stop the run.
class RunJudge : public RunObserver {
 public:
  explicit RunJudge(RunContext& run) : run_(run), check_(run.info(), run.used, run.source.calibration.has_extrinsics) {}

  void on_measurement(const Measurement& measurement) override {
    const auto timer = run_.timings.measure_often("check");
    check_.add(measurement);
    for (const Finding& finding : check_.news()) spdlog::error(fmt::format("{}: {}", finding.text, finding.remedy));
  }

  void on_summary(RunEnd& end) override {
    RunSummary& summary = end.summary;
    summary.calibration =
        compare_calibrations(run_.source.calibration.rig, run_.odometry, run_.config.odometry.estimator.calibration);
    for (Finding& finding : check_.findings(*run_.source.dataset, end.truth))
      summary.verdict.findings.push_back(std::move(finding));
    judge_external(run_.odometry.counters(), summary.verdict.findings);
    judge_rig(run_.source.calibration.rig, run_.odometry.rig(), run_.config.odometry.estimator.calibration,
              summary.verdict.findings);
    for (CalibrationFound& found : summary.calibration)
      found.beyond = found.beyond && !check_.agrees_with(run_.odometry.rig().camera(found.camera));
  }

 private:
  RunContext& run_;
  RunCheck check_;
};

}  // namespace

std::vector<CorrectionFound> corrections_of(const RigCamera& given, const RigCamera& found,
                                            const CalibrationCovariance& P, const CalibrationConfig& config) {
  using namespace calibration_at;
  const CalibrationVector off = correction_between(given, found), prior = calibration_sigmas(config, given.model);
  const double fx = given.model.fx(), fy = given.model.fy();
  struct Number {
    std::string name;
    Eigen::Index at;
    double unit;
  };
  std::vector<Number> numbers{{"x_mm", kLeverArm, 1e3},          {"y_mm", kLeverArm + 1, 1e3},
                              {"z_mm", kLeverArm + 2, 1e3},      {"fx_percent", kFocal, 100.0},
                              {"fy_percent", kFocal + 1, 100.0}, {"cx_px", kCentre, fx},
                              {"cy_px", kCentre + 1, fy}};
  const std::vector<std::string_view> coefficients = coefficient_names(lens_model(given.model.distortion()));
  for (int i = 0; i < corrected_coefficients(given.model); ++i)
    numbers.push_back({std::string(coefficients[static_cast<std::size_t>(i)]), kDistortion + i, 1.0});
  std::vector<CorrectionFound> out;
  for (const auto& [name, at, unit] : numbers)
    out.push_back({name, unit * off[at], unit * std::sqrt(P(at, at)), unit * prior[at]});
  return out;
}

std::vector<CalibrationFound> compare_calibrations(const Rig& given, Odometry& odometry,
                                                   const CalibrationConfig& config) {
  constexpr double kBeyond = 4.0;  // sigmas of the prior
  std::vector<CalibrationFound> out;
  for (const RigCamera& camera : odometry.rig().cameras) {
    const RigCamera& before = given.camera(camera.name);
    const Eigen::Vector3d turned = so3::log((before.T_B_C.inverse() * camera.T_B_C).rotation());
    CalibrationFound found{camera.name,
                           kDegreesPerRadian * turned.norm(),
                           1e3 * to_seconds(camera.time_offset),
                           1e3 * to_seconds(before.time_offset),
                           false,
                           std::nullopt,
                           std::nullopt};
    found.beyond = found.rotation_deg > kBeyond * config.rotation_sigma_deg ||
                   std::abs(found.time_offset_ms - found.given_offset_ms) > kBeyond * config.time_offset_sigma_ms;
    found.events = camera.modality == Modality::Events;
    if (const auto P = odometry.calibration_covariance(camera.name)) {
      const Eigen::Matrix3d rotation = P->block<3, 3>(calibration_at::kRotation, calibration_at::kRotation);
      // Of the estimated angle; if that is zero, of the least certain axis.
      const Eigen::Vector3d axis = turned.normalized();
      const double variance = turned.norm() > 0.0
                                  ? axis.dot(rotation * axis)
                                  : Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rotation).eigenvalues()[2];
      found.rotation_sigma_deg = kDegreesPerRadian * std::sqrt(variance);
      found.time_sigma_ms = 1e3 * std::sqrt((*P)(calibration_at::kTime, calibration_at::kTime));
      found.corrections = corrections_of(before, camera, *P, config);
      found.inverse = fits_inverse(before.T_B_C, camera.T_B_C, found.rotation_deg, *found.rotation_sigma_deg);
    }
    out.push_back(found);
  }
  return out;
}

Calibration with_found(Calibration given, const Rig& found) {
  const Rig before = given.rig;
  for (RigCamera& camera : given.rig.cameras) {
    for (const RigCamera& calibrated : found.cameras) {
      if (!is_same_lens(before.camera(camera.name), before.camera(calibrated.name))) continue;
      camera.model = calibrated.model;
      camera.T_B_C = calibrated.T_B_C;
      if (camera.name == calibrated.name) camera.time_offset = calibrated.time_offset;
    }
  }
  return given;
}

void judge_run(RunSummary& s, const SourceOptions& source, Ending ending) {
  Verdict& verdict = s.verdict;
  const RunStatistics& statistics = s.statistics;
  const bool ever_good = statistics.first_good_s().has_value();
  if (!imu_unusable(verdict.findings))
    for (const CalibrationFound& found : s.calibration) {
      judge_calibration(found, verdict.findings);
      judge_lens_and_position(found, verdict.findings);
    }
  if (ever_good) {
    judge_losses(statistics, s.map && s.map->localize_only, verdict.findings);
    if (!imu_unusable(verdict.findings)) judge_biases(statistics, verdict.findings);
  }
  if (s.live) judge_live(*s.live, statistics, verdict.findings);
  judge_against_truth(s, verdict.findings);
  const bool lost = statistics.last_status() == TrackingStatus::Lost;
  if (!ever_good || lost) verdict.waiting_for = statistics.waiting_for();
  verdict.contradicted = std::ranges::count(verdict.findings, Severity::Error, &Finding::severity) > 0;
  if (!ever_good) judge_no_start(statistics, source, ending, verdict);
  verdict.trusted = ever_good && !verdict.contradicted;
  if (verdict.next.empty())
    verdict.next = verdict.trusted ? fmt::format("open {}/report.html", s.folder) : command_line("doctor", source);
  s.status = status_of(statistics, verdict, ending);
  verdict.text = text_of(s, ending);
}

std::unique_ptr<RunObserver> observe_verdict(RunContext& run) { return std::make_unique<RunJudge>(run); }

}  // namespace edged
