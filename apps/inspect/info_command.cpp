// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <memory>
#include <string>

#include "common/command.hpp"
#include "common/interrupt.hpp"
#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "inspect/survey.hpp"

namespace edged {
namespace {

struct InfoOptions {
  SourceOptions source;
  bool quiet = false, json = false;
};

std::string calibration_text(const Recording& recording) {
  if (!recording.calibration) return "none: give --rig or --calib";
  std::string cameras;
  for (const RigCamera& camera : recording.calibration->rig.cameras) cameras += " " + camera.name;
  return (recording.calibration->has_extrinsics ? "cameras and IMU:" : "intrinsics only:") + cameras;
}

/// An unknown sensor size is no error here: it is estimated from the pixels with events.
Recording open_of_any_size(SourceOptions source) {
  try {
    return open_uncalibrated(source);
  } catch (const UnknownSensorSize& unknown) {
    source.geometry = "2048x2048";
    spdlog::warn(fmt::format("{}, by the pixels below; here it is read as {}", unknown.what(), source.geometry));
    return open_uncalibrated(source);
  }
}

int run_info(const InfoOptions& options) {
  catch_interrupts();
  const Recording recording = open_of_any_size(options.source);
  RecordingCollector collector(recording.dataset->info());
  const WholeRead read = read_whole(*recording.dataset, options.quiet, [&](const Measurement& m) { collector.add(m); });
  const RecordingStatistics survey = collector.result(*recording.dataset, read.truth);
  print_result(options.json, to_json(survey),
               fmt::format("{}{:<15} {}\n{:<15} {}\n", to_text(survey), "calibration", calibration_text(recording),
                           "next", command_line("doctor", options.source)));
  if (read.damage) throw InputError(*read.damage);
  if (interrupt_signal() != 0) spdlog::warn("interrupted: the counts cover the part that was read");
  return exit_code_of_interrupt();
}

}  // namespace

void add_info_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* info = app.add_subcommand("info", "Describe a recording: streams, rates, gaps, hot pixels, IMU noise");
  add_source_options(*info, options->source);
  add_cameras_option(*info, options->source);
  finish_command(*info, options, "Example:\n  edged info flight.bag", chosen, run_info);
}

}  // namespace edged
