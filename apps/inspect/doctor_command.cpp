// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/findings.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/reading.hpp"
#include "edged/checks/found_imu_clock.hpp"
#include "edged/checks/recording_check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/core/camera_names.hpp"
#include "inspect/survey.hpp"

namespace edged {
namespace {

struct DoctorOptions {
  SourceOptions source;
  bool quiet = false, json = false;
};

std::optional<CheckedCalibration> calibration_to_check(const Recording& recording) {
  const auto& given = recording.calibration;
  if (!given) return std::nullopt;
  return CheckedCalibration{calibrated_cameras(recording), given->has_extrinsics, given->known_noise()};
}

/// Warnings while reading are findings, too: the summary contains everything that is printed.
void add_log(std::vector<std::string> lines, std::vector<Finding>& findings) {
  for (std::string& line : lines) findings.push_back({Severity::Warning, std::move(line), ""});
}

std::string next_step(const DoctorOptions& options, const Recording& recording, bool ill) {
  if (ill) return "correct the errors above, then " + command_line("doctor", options.source);
  if (!recording.calibration || !recording.calibration->has_extrinsics) {
    SourceOptions calibrated = options.source;
    calibrated.rig.clear();
    calibrated.calib = "head.yaml";
    return "edged calib --target KIND --size MM MOVED --out head.yaml (MOVED: another recording, of a target), then " +
           command_line("doctor", calibrated);
  }
  return command_line("run", options.source);
}

/// A run uses all recorded kinds of cameras unless --mode leaves one out.
void add_missing_cameras(const Recording& recording, std::vector<Finding>& findings) {
  const std::vector<RigCamera> calibrated = calibrated_cameras(recording);
  if (calibrated.empty()) return;
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    const auto recorded = recorded_cameras(recording.dataset->info());
    if (std::ranges::find(recorded, modality, &RecordedCamera::modality) == recorded.end()) continue;
    if (std::ranges::find(calibrated, modality, &RigCamera::modality) != calibrated.end()) continue;
    findings.push_back({Severity::Warning, fmt::format("the calibration has no camera of the {}", kind_name(modality)),
                        fmt::format("{}; else run with --mode {}",
                                    davis_remedy(recording.calibration->rig.cameras.front().name, "head.yaml"),
                                    kind_name(calibrated.front().modality))});
  }
}

int run_doctor(const DoctorOptions& options) {
  catch_interrupts();
  HeldWarnings held;
  const Recording recording = open_uncalibrated(options.source);
  RecordingCheck check(recording.dataset->info(), calibration_to_check(recording), RecordingCheck::Effort::Thorough);
  bool has_pictures = false;
  const WholeRead read = read_whole(*recording.dataset, options.quiet, [&](const Measurement& measurement) {
    check.add(measurement);
    has_pictures |= camera_of(measurement) != nullptr && first_stamp(measurement);
  });
  if (interrupt_signal() != 0) return exit_code_of_interrupt();
  std::vector<Finding> findings = check.findings(*recording.dataset, read.truth);
  if (!has_pictures)
    if (const auto start_s = cameras_start_after_s(options.source)) findings = {cameras_start_later(*start_s)};
  if (const auto clock = found_imu_clock(options.source))
    findings.push_back(
        {Severity::Note,
         fmt::format("IMU clock: {} were added to its stamps, {}", offset_text(*clock), offset_evidence(*clock->found)),
         ""});
  if (recording.calibration) add_missing_cameras(recording, findings);
  add_log(held.take(), findings);
  if (read.damage)
    findings.push_back({Severity::Error, *read.damage, "the findings above cover the recording up to there"});
  const bool ill = has_error(findings);
  print_result(options.json, to_json(findings),
               to_text(findings) + "next     " + next_step(options, recording, ill) + "\n");
  return ill ? kExitInput : kExitOk;
}

}  // namespace

void add_doctor_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<DoctorOptions>();
  CLI::App* doctor = app.add_subcommand(
      "doctor", "Check a recording and its calibration and propose remedies (exit code 3 for errors)");
  add_source_options(*doctor, options->source);
  add_cameras_option(*doctor, options->source);
  finish_command(*doctor, options, "Example:\n  edged doctor flight.bag --calib camchain-imucam.yaml", chosen,
                 run_doctor);
}

}  // namespace edged
