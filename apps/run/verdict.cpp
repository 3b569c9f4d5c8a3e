// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/verdict.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "edged/core/angles.hpp"
#include "edged/survey/run_check.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

/// One word of a command line.
std::string shell_word(const std::string& text) {
  const bool plain =
      text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=,+-~") ==
      std::string::npos;
  if (plain && !text.empty()) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string doctor_command(const SourceOptions& source) {
  std::string command = "edged doctor " + shell_word(source.recording);
  const auto add = [&command](const char* name, const std::string& value) {
    if (!value.empty()) command += fmt::format(" {} {}", name, shell_word(value));
  };
  add("--rig", source.rig);
  add("--calib", source.calib.string());
  add("--imu", source.imu.string());
  if (source.imu_clock_rate != 1.0) add("--imu-clock-rate", fmt::format("{}", source.imu_clock_rate));
  add("--geometry", source.geometry);
  add("--time-unit", source.time_unit);
  for (const std::string& topic : source.topics) add("--topic", topic);
  if (source.piece.from_s > 0.0) add("--from", fmt::format("{}", source.piece.from_s));
  if (source.piece.to_s) add("--to", fmt::format("{}", *source.piece.to_s));
  if (source.duration_s) add("--duration", fmt::format("{}", *source.duration_s));
  if (source.dim_frames) add("--dim-frames", fmt::format("{}", *source.dim_frames));
  return command;
}

/// What it found is a finding only where the calibration is wrong by more than the estimate may be.
void judge_calibration(const CalibrationFound& c, std::vector<Finding>& out) {
  constexpr double kSigmas = 3.0, kLeast_deg = 1.0, kLeast_ms = 5.0;  // below these it costs nothing
  const double shift_ms = c.time_offset_ms - c.given_offset_ms;
  const Severity severity = c.beyond ? Severity::Error : Severity::Warning;
  const std::string done = c.beyond ? "more than a run can correct" : "the run has corrected it";
  if (c.inverse)
    out.push_back({severity,
                   fmt::format("camera {}: its rotation to the IMU was found {:.2f} deg +- {:.2f} deg off the "
                               "calibration, the inverse fits",
                               c.camera, c.rotation_deg, *c.rotation_sigma_deg),
                   kTurnRound});
  else if (c.rotation_sigma_deg && c.rotation_deg > std::max(kLeast_deg, kSigmas * *c.rotation_sigma_deg))
    out.push_back({severity,
                   fmt::format("camera {}: its rotation to the IMU is {:.2f} deg +- {:.2f} deg off the calibration",
                               c.camera, c.rotation_deg, *c.rotation_sigma_deg),
                   done + "; calibrate camera and IMU anew"});
  if (c.time_sigma_ms && std::abs(shift_ms) > std::max(kLeast_ms, kSigmas * *c.time_sigma_ms))
    out.push_back({severity,
                   fmt::format("camera {}: t_imu = t_cam {:+.2f} ms +- {:.2f} ms was estimated, {:+.2f} ms is given",
                               c.camera, c.time_offset_ms, *c.time_sigma_ms, c.given_offset_ms),
                   fmt::format("{}; set time_offset of this camera to {:.4f}", done, 1e-3 * c.time_offset_ms)});
}

/// Calibrations are good to a degree: a smaller turn tells no direction. The inverse must lie far nearer.
bool fits_inverse(const SE3& given, const SE3& found, double found_deg, double sigma_deg) {
  constexpr double kLeast_deg = 1.0, kSigmas = 4.0, kNearer = 0.4;
  const double inverse_deg = kDegreesPerRadian * so3::log(given.rotation() * found.rotation()).norm();
  return found_deg > std::max(kLeast_deg, kSigmas * sigma_deg) && inverse_deg < kNearer * found_deg;
}

/// What does not fit goes into the biases first.
void judge_biases(const RunStatistics& run, std::vector<Finding>& out) {
  constexpr double kMost = 1.2;  // [m/s^2]; up to 0.5 on the mirror recordings
  if (run.accel_bias().norm() > kMost)
    out.push_back({Severity::Error,
                   fmt::format("accelerometer: a bias of {:.1f} m/s^2 was estimated, more than such sensors have",
                               run.accel_bias().norm()),
                   "check its axes, scale and unit, and the pose of the cameras to it"});
}

void judge_losses(const RunStatistics& run, std::vector<Finding>& out) {
  constexpr double kMostLost = 0.1;
  const double lost_s = run.time_in_s(TrackingStatus::Lost);
  const std::string why = run.lost_because().empty() ? "" : ", the last time as " + run.lost_because();
  const std::string remedy =
      "after a loss position and yaw are those of dead reckoning: look into states.csv and run.log";
  if (run.last_status() == TrackingStatus::Lost)
    out.push_back({Severity::Error, fmt::format("lost at the end{}", why), remedy});
  else if (run.lost_share() > kMostLost)
    out.push_back({Severity::Error,
                   fmt::format("lost for {:.1f} s, {:.0f} % of the time{}", lost_s, 100 * run.lost_share(), why),
                   remedy});
  else if (run.times_lost() > 0)
    out.push_back(
        {Severity::Warning, fmt::format("lost {} times, for {:.1f} s{}", run.times_lost(), lost_s, why), remedy});
}

/// What contradicts is told as soon as it is known: who watches can stop there.
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
    summary.verdict = judge_run(check_.findings(*run_.source.dataset, end.truth), run_.statistics, summary.calibration,
                                run_.options.source);
  }

 private:
  RunContext& run_;
  RunCheck check_;
};

}  // namespace

std::vector<CalibrationFound> compare_calibrations(const Rig& given, Odometry& odometry,
                                                   const CalibrationConfig& config) {
  constexpr double kBeyond = 4.0;  // sigmas of what was thought possible
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
    if (const auto P = odometry.calibration_covariance(camera.name)) {
      const Eigen::Matrix3d rotation = P->topLeftCorner<3, 3>();
      // Of the angle that was found; where there is none, of the axis that is known least.
      const Eigen::Vector3d axis = turned.normalized();
      const double variance = turned.norm() > 0.0
                                  ? axis.dot(rotation * axis)
                                  : Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rotation).eigenvalues()[2];
      found.rotation_sigma_deg = kDegreesPerRadian * std::sqrt(variance);
      found.time_sigma_ms = 1e3 * std::sqrt((*P)(3, 3));
      found.inverse = fits_inverse(before.T_B_C, camera.T_B_C, found.rotation_deg, *found.rotation_sigma_deg);
    }
    out.push_back(found);
  }
  return out;
}

Calibration with_found(Calibration given, const Rig& found) {
  for (RigCamera& camera : given.rig.cameras) {
    const auto same = std::ranges::find(found.cameras, camera.name, &RigCamera::name);
    if (same == found.cameras.end()) continue;
    camera.T_B_C = same->T_B_C;
    camera.time_offset = same->time_offset;
  }
  return given;
}

Verdict judge_run(std::vector<Finding> findings, const RunStatistics& statistics,
                  const std::vector<CalibrationFound>& calibration, const SourceOptions& source) {
  Verdict verdict;
  verdict.findings = std::move(findings);
  if (!imu_unusable(verdict.findings))
    for (const CalibrationFound& found : calibration) judge_calibration(found, verdict.findings);
  const bool ever_good = statistics.first_good_s().has_value();
  if (ever_good) {
    judge_losses(statistics, verdict.findings);
    if (!imu_unusable(verdict.findings)) judge_biases(statistics, verdict.findings);
  }
  verdict.contradicted = std::ranges::count(verdict.findings, Severity::Error, &Finding::severity) > 0;
  verdict.trusted = ever_good && !verdict.contradicted;
  const bool lost = statistics.last_status() == TrackingStatus::Lost;
  if (!ever_good || lost) verdict.waiting_for = statistics.waiting_for();
  if (!verdict.trusted) verdict.next = doctor_command(source);
  if (!ever_good) {
    const std::string why = statistics.packets() == 0     ? "not one packet had IMU samples around it"
                            : verdict.waiting_for.empty() ? "no start was tried"
                                                          : "it waited for " + verdict.waiting_for;
    verdict.findings.push_back({Severity::Error, "never good: " + why,
                                "see what recording and calibration say of themselves: " + verdict.next});
  }
  return verdict;
}

std::unique_ptr<RunObserver> observe_verdict(RunContext& run) { return std::make_unique<RunJudge>(run); }

}  // namespace edged
