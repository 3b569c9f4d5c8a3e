// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib/calib.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/command.hpp"
#include "common/files.hpp"
#include "common/findings.hpp"
#include "common/interrupt.hpp"
#include "common/source.hpp"
#include "common/status_line.hpp"
#include "edged/checks/calibration_fit.hpp"
#include "edged/checks/recording_check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/odometry.hpp"
#include "edged/pipeline/mode.hpp"
#include "run/estimated_calibration.hpp"
#include "run/run_statistics.hpp"

namespace edged {
namespace {

/// Each camera is checked by itself: event frames keep all their features and packets, as without frames.
OdometryConfig asking_each_camera() {
  OdometryConfig config;
  config.packets.min_interval_s = 0.015;
  config.estimator.event_noise_inflation = 1.0;
  return config;
}

/// A run like that of `edged run`, without its files.
class CheckRun {
 public:
  /// begin: the initial calibration of the cameras.
  CheckRun(Source& source, const Rig& begin, Mode mode, bool quiet)
      : source_(source),
        check_(source.dataset->info(),
               CheckedCalibration{used_cameras(source.calibration.rig, mode).cameras, source.calibration.has_extrinsics,
                                  source.calibration.known_noise()},
               RecordingCheck::Effort::DuringRun),
        odometry_(begin, source.calibration.imu, mode, config_, {kInOrder}),
        status_(quiet),
        rig_(odometry_.rig()),
        found_(compare()) {}

  void go() {
    InterruptibleDataset recording(*source_.dataset);
    drive(
        odometry_, [&] { return next(recording); }, [&](const Step& step) { return observe(step); });
    status_.clear();
  }

  CalibrationFit fit() {
    return judge_fit(found_, check_.findings(*source_.dataset, read_truth(source_).truth), statistics_.waiting_for());
  }
  /// The estimated calibration, from all measurements up to the last good estimate.
  const Rig& rig() const { return rig_; }
  const CalibrationCovariances& covariances() const { return covariances_; }

 private:
  std::optional<Measurement> next(Dataset& recording) {
    std::optional<Measurement> measurement = recording.next();
    if (measurement) check_.add(*measurement);
    return measurement;
  }

  /// After a loss there is no estimate, so the last good one is kept.
  bool observe(const Step& step) {
    constexpr Duration kEvery = std::chrono::milliseconds(500);
    statistics_.add(step);
    if (step.status == TrackingStatus::Good && (!compared_ || step.t - *compared_ >= kEvery)) {
      compared_ = step.t;
      rig_ = odometry_.rig();
      found_ = compare();
    }
    show_progress(status_, step.t, source_.dataset->info(), "checked");
    return interrupt_signal() == 0;
  }

  std::vector<CalibrationFound> compare() {
    const CalibrationCovariances present = calibration_covariances(odometry_);
    for (const auto& [camera, P] : present) covariances_[camera] = P;
    return compare_calibrations(source_.calibration.rig, rig_, present, config_.estimator.calibration);
  }

  Source& source_;
  OdometryConfig config_ = asking_each_camera();
  RecordingCheck check_;
  Odometry odometry_;
  StatusLine status_;
  RunStatistics statistics_;
  std::optional<Timestamp> compared_;
  Rig rig_;
  CalibrationCovariances covariances_;
  std::vector<CalibrationFound> found_;
};

bool estimated(const CalibrationFit& fit) {
  return std::ranges::all_of(fit.cameras, [](const CameraFit& camera) { return camera.found.estimated(); });
}

/// If the run estimates a wrong calibration, it is repeated from that estimate: measurements processed with the wrong
/// one bias it by up to 1.6 ms.
CalibrationRun check(const CalibOptions& options, const SourceOptions& reopened, Source& source, Mode mode) {
  CalibrationRun first = calibrate_by_run(source.calibration.rig, source, mode, options.quiet);
  const bool off = std::ranges::any_of(first.fit.cameras, [](const CameraFit& camera) { return is_off(camera.found); });
  if (!off || interrupt_signal() != 0 || is_live(reopened)) return first;
  source.dataset = open_uncalibrated(reopened).dataset;
  CalibrationRun second = calibrate_by_run(first.estimated, source, mode, options.quiet);
  return estimated(second.fit) ? second : first;
}

int exit_code_of(Fit fit) {
  return fit == Fit::Fits ? kExitOk : fit == Fit::DoesNotFit ? kExitNotTrusted : kExitNeverGood;
}

std::string next_line(const CalibOptions& options, SourceOptions whole, Fit fit) {
  whole.duration_s.reset();
  if (!options.out.empty()) whole.calib = options.out;
  const bool usable = fit == Fit::Fits || !options.out.empty();
  return fmt::format("{:<11} {}\n", "next", command_line(usable ? "run" : "doctor", whole));
}

}  // namespace

CalibrationRun calibrate_by_run(const Rig& begin, Source& source, Mode mode, bool quiet) {
  CheckRun run(source, begin, mode, quiet);
  run.go();
  return {run.fit(), run.rig(), run.covariances()};
}

int check_calibration(const CalibOptions& options) {
  catch_interrupts();
  if (!options.out.empty()) check_writable(options.out, "--out");
  SourceOptions checked = options.source_with_file();
  if (!checked.piece.to_s && !checked.duration_s) checked.duration_s = kCheckedSeconds;
  Source source = open_source(checked);
  const Mode mode = choose_mode(options.mode, source.dataset->info());
  match_cameras(source, mode);
  const auto [fit, estimated, covariances] = check(options, checked, source, mode);
  if (interrupt_signal() != 0) return exit_code_of_interrupt();
  print_result(options.json, to_json(fit), to_text(fit) + next_line(options, checked, fit.fit));
  if (!options.out.empty()) write_file(options.out, to_yaml(with_estimated(source.calibration, estimated)));
  return exit_code_of(fit.fit);
}

}  // namespace edged
