// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/verdict.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "common/findings.hpp"
#include "common/text.hpp"
#include "edged/checks/checks.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"

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
                   done + "; calibrate camera and IMU again"});
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
  // A focal length 3 % off, 6 sigma, is found to a quarter of that. Of seven runs with 5 to 10 %, 8 sigma or more, four
  // were lost, and the estimates were at most 6 % off.
  constexpr double kMostCorrected = 7.0;
  std::string list;
  bool corrected = true;
  for (const CorrectionFound& number : c.corrections) {
    if (!number.beyond()) continue;
    corrected = corrected && !number.beyond(kMostCorrected);
    const std::string what = number.name.substr(0, number.name.find('_'));
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", what, amount(number));
  }
  if (list.empty()) return;
  out.push_back(
      {corrected ? Severity::Warning : Severity::Error,
       fmt::format("camera {}: differs from the calibration by {}", c.camera, list),
       corrected ? "the run has corrected it; pass calibration_found.yaml of this run with --calib, or calibrate again"
                 : "more than a run can correct: choose the calibration of this lens, or calibrate it again"});
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

/// A motion may be too gentle for an IMU to tell its size.
void judge_scale(const RunStatistics& run, double max_sigma, std::vector<Finding>& out) {
  if (run.scale_sigma().value_or(0.0) > max_sigma)
    out.push_back({Severity::Error,
                   fmt::format("scale: known to {:.0f} %, as the motion is too gentle for this IMU: distances may be "
                               "off by that share",
                               100.0 * *run.scale_sigma()),
                   "move faster, use a second camera of known baseline, or a height or velocity sensor"});
}

/// With --localize-only a loss is silence: no pose depends on dead reckoning. explained: by a cause that is named.
void judge_losses(const RunStatistics& run, bool localize_only, bool explained, std::vector<Finding>& out) {
  constexpr double kMostLost = 0.1;
  const Severity severe = localize_only ? Severity::Warning : Severity::Error;
  const double lost_s = run.time_in_s(TrackingStatus::Lost);
  const std::string why = explained || run.lost_because().empty() ? "" : ", the last time as " + run.lost_because();
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
    const std::string lost = fmt::format("lost {}, for {:.1f} s{}", quantity(run.times_lost(), "time"), lost_s, why);
    if (run.times_contradicted() > 0)
      out.push_back({severe, lost, "the last poses before a contradiction are wrong: see states.csv and run.log"});
    else
      out.push_back({Severity::Warning, lost, remedy});
  }
}

/// Latency of the results, and the share that was dropped.
void judge_live(const LiveSummary& live, const RunStatistics& run, std::vector<Finding>& out) {
  constexpr double kSome = 0.1, kMost = 0.5, kLate = 4.0;
  const RunStatistics::Overload overload = run.overload();
  const double late_s = live.latency.quantile_s(0.50);
  const bool too_late = late_s > kLate * live.max_age_s;
  if (overload.share < kSome && !too_late) return;
  out.push_back(
      {overload.share > kMost || too_late ? Severity::Error : Severity::Warning,
       fmt::format("live: too slow for this recording: {}, latency {:.2f} s (median; live.max_age_s {:g})",
                   overload.text, late_s, live.max_age_s),
       overload.by_reading
           ? "record fewer events a second, or use a faster computer"
           : "raise packets.min_interval_s, lower tracker.detector.max_features, choose another --mode, or use a "
             "faster computer"});
}

/// An offset between the stamps explains the other contradictions.
void judge_against_truth(const RunSummary& s, std::vector<Finding>& out) {
  constexpr double kMostOutside = 0.5, kGrossNees = 140.0;
  constexpr double kLeast_percent = 1.0;  // of the path: a smaller error is of use although its covariance is wrong
  if (s.truth.offset && s.truth.offset->matters()) {
    const TimeOffset& offset = *s.truth.offset;
    out.push_back(
        {Severity::Warning,
         fmt::format("ground truth: its stamps are {:.1f} ms {}: with that offset the ATE is {:.2f} mm, as given "
                     "{:.2f} mm",
                     1e3 * std::abs(offset.offset_s), offset.offset_s > 0 ? "late" : "early", 1e3 * offset.ate_rmse_m,
                     1e3 * offset.ate_given_m),
         fmt::format("add {:.4f} s to its stamps; `edged eval` takes the file as it is", -offset.offset_s)});
  } else if (s.truth.consistency && s.truth.consistency->silent_s() > 0.0) {
    const Consistency& c = *s.truth.consistency;
    const double path_m = std::max(s.truth.evaluation->path_length_m, kShortestPath_m);
    const bool gross = 100.0 * s.truth.evaluation->ate_m.mean > kLeast_percent * path_m &&
                       (c.silent_s() > kMostOutside * s.truth.evaluation->duration_s ||
                        std::max(c.position.max_nees, c.rotation.max_nees) > kGrossNees);
    out.push_back(
        {gross ? Severity::Error : Severity::Warning,
         fmt::format("ground truth: the estimate is outside 3 sigma of its covariance for {:.1f} s", c.silent_s()),
         "its errors are larger than its covariance: see `error since the start` in report.html; or the true poses are "
         "of another sensor: run with `--frame SENSOR`, then `edged eval`"});
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
  const std::string why = statistics.packets() == 0     ? "no packet had IMU samples before and after it"
                          : verdict.waiting_for.empty() ? "no initialization was tried"
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
  if (!verdict.trusted)
    return error->text.starts_with(verdict.status) ? error->text : verdict.status + ": " + error->text;
  if (verdict.status != "good") return "nothing contradicts the result, but it ends " + verdict.status;
  if (verdict.findings.empty()) return "nothing contradicts the result";
  return "nothing contradicts the result, but note: " + verdict.findings.front().text;
}

}  // namespace

void judge_run(RunSummary& s, const SourceOptions& source, Ending ending) {
  Verdict& verdict = s.verdict;
  const RunStatistics& statistics = s.statistics;
  const bool ever_good = statistics.first_good_s().has_value();
  // What is wrong with recording or calibration explains what was estimated with it.
  const bool explained = has_error(verdict.findings);
  if (!explained && !is_unusable(Unusable::Calibration, verdict.findings))
    for (const CalibrationFound& found : s.calibration) {
      judge_calibration(found, verdict.findings);
      judge_lens_and_position(found, verdict.findings);
    }
  if (ever_good) {
    judge_losses(statistics, s.run.localize_only, explained, verdict.findings);
    if (!explained) {
      judge_scale(statistics, s.run.max_scale_sigma, verdict.findings);
      judge_biases(statistics, verdict.findings);
    }
  }
  if (s.live) judge_live(*s.live, statistics, verdict.findings);
  if (!explained && !is_unusable(Unusable::Truth, verdict.findings)) judge_against_truth(s, verdict.findings);
  const bool lost = statistics.last_status() == TrackingStatus::Lost;
  if (!ever_good || lost) verdict.waiting_for = statistics.waiting_for();
  verdict.contradicted = has_error(verdict.findings);
  if (!ever_good) judge_no_start(statistics, source, ending, verdict);
  verdict.trusted = ever_good && !verdict.contradicted;
  if (verdict.next.empty())
    verdict.next = verdict.trusted ? fmt::format("open {}/report.html", s.run.folder) : command_line("doctor", source);
  verdict.status = status_of(statistics, verdict, ending);
  verdict.text = text_of(s, ending);
}

}  // namespace edged
