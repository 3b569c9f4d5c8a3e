// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib --target`: cameras and IMU calibrated from a recording of a target; `--print-target`: the target.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/cli_fwd.hpp"
#include "common/source.hpp"

namespace edged {

/// What the target is, as given; the rest is that of the usual target of its kind.
struct TargetOptions {
  std::string kind;  ///< "" without --target
  std::optional<int> rows, columns;
  std::optional<double> size_mm, ratio;
};

struct CalibTargetOptions {
  TargetOptions target;
  SourceOptions source;
  std::string mode = "auto", lens = "radtan", format = "edged";
  bool no_imu = false;
  std::filesystem::path out, report;
  bool quiet = false, json = false;
};

/// Adds --target, --rows, --columns, --size, --ratio, --lens, --format, --cameras, --no-imu and --report.
void add_target_options(CLI::App& calib, CalibTargetOptions& options);

/// Writes svg or pdf, by the ending of the file.
int print_target(const TargetOptions& target, const std::filesystem::path& file);

/// Prints the calibration with its sigmas, writes --out and the report, and returns the exit code.
int calibrate_from_target(CalibTargetOptions options);

}  // namespace edged
