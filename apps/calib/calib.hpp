// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib`: its options, and each of the things that it does.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/cli.hpp"
#include "common/source.hpp"
#include "edged/checks/calibration_fit.hpp"
#include "run/estimated_calibration.hpp"

namespace edged {

/// What the target is, as given; the rest is that of the usual target of its kind.
struct TargetOptions {
  std::string kind;  ///< "" without --target
  std::optional<int> rows, columns;
  std::optional<double> size_mm, ratio;
  std::string lens = "auto", format = "edged";
  std::vector<std::string> cameras;  ///< to read; empty: all
  bool no_imu = false;
  std::filesystem::path report, print;  ///< files of --report and --print-target
};

struct CalibOptions {
  std::string file;                ///< a calibration, or the recording of --target and --imu-noise
  std::string camera_of_template;  ///< of --new
  std::filesystem::path imu, out;
  std::vector<std::string> cameras;  ///< NAME=events|frames|both[:NEW_NAME]
  SourceOptions source;              ///< the recording of --check, and how recordings are read
  std::vector<std::string> refined;  ///< recordings of --refine
  std::string mode = "auto";
  TargetOptions target;
  bool imu_noise = false;
  bool quiet = false, json = false;

  /// How to read a recording, with the calibration FILE as by --calib or --rig.
  SourceOptions source_with_file() const;
  /// How to read FILE, a recording.
  SourceOptions source_of_file() const;
};

inline constexpr double kCheckedSeconds = 20.0;  ///< default length of the part of a recording that --check uses

/// What a run over a recording estimated.
struct CalibrationRun {
  CalibrationFit fit;
  Rig estimated;
  CalibrationCovariances covariances;
};

/// A run like that of `edged run`, without its files, that checks each camera by itself. begin: the initial calibration
/// of the cameras.
CalibrationRun calibrate_by_run(const Rig& begin, Source& source, Mode mode, bool quiet);

/// --check: prints whether a calibration fits a recording, by a short run over it. Returns the exit code: 0 fits, 5
/// does not, 4 cannot be determined.
int check_calibration(const CalibOptions& options);

/// --refine: runs over each recording from one calibration, prints what they estimate together, and writes it. Returns
/// the exit code: 4 where no recording gave an estimate.
int refine_calibration(const CalibOptions& options);

/// --imu-noise: prints the Allan deviation of each axis of an IMU at rest and the noise fitted to it, and writes that
/// as a Kalibr imu yaml. Throws InputError for a recording that is short or moves.
int measure_imu_noise(const CalibOptions& options);

/// Adds --target, --rows, --columns, --size, --ratio, --lens, --format, --cameras, --no-imu and --report.
void add_target_options(CLI::App& calib, TargetOptions& options);

/// --print-target: writes svg or pdf, by the ending of the file.
int print_target(const CalibOptions& options);

/// --target: prints the calibration of cameras and IMU with its sigmas, writes --out and the report.
int calibrate_from_target(const CalibOptions& options);

/// --new: cameras of which there is a template, and that of one of them: a calibration to fill in.
std::vector<std::string> template_names();
std::string calibration_template(const std::string& camera);

}  // namespace edged
