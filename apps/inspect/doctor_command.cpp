// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/findings.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "edged/checks/agreement/accel_axes.hpp"
#include "edged/checks/agreement/external_agreement.hpp"
#include "edged/checks/agreement/lens_agreement.hpp"
#include "edged/checks/agreement/stereo_agreement.hpp"
#include "edged/checks/checks.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "inspect/survey.hpp"

namespace edged {
namespace {

struct DoctorOptions {
  SourceOptions source;
  bool quiet = false, json = false;
};

/// A camera of the calibration, and its name in the recording.
struct CheckedCamera {
  RigCamera camera;
  std::string recorded;
};

/// The recorded cameras that the calibration has: those of the same name, and of each kind its first for the first.
std::vector<CheckedCamera> cameras_to_check(const Recording& recording) {
  std::vector<CheckedCamera> cameras;
  const DatasetInfo& info = recording.dataset->info();
  if (!recording.calibration || !info.has_imu) return cameras;
  const Rig& rig = recording.calibration->rig;
  for (const RecordedCamera& recorded : recorded_cameras(info)) {
    const auto named = std::ranges::find(rig.cameras, recorded.name, &RigCamera::name);
    const bool known = named != rig.cameras.end() && named->modality == recorded.modality;
    const bool first = recorded.name == info.event_camera || recorded.name == info.frame_camera;
    const RigCamera* camera = known ? &*named : first ? rig.find(recorded.modality) : nullptr;
    if (camera) cameras.push_back({*camera, recorded.name});
  }
  return cameras;
}

std::vector<RigCamera> as_recorded(const std::vector<CheckedCamera>& cameras) {
  std::vector<RigCamera> named;
  for (const CheckedCamera& checked : cameras) {
    named.push_back(checked.camera);
    named.back().name = checked.recorded;
  }
  return named;
}

/// Warnings while reading are findings, too: the summary contains everything that is printed.
void add_log(std::vector<std::string> lines, std::vector<Finding>& findings) {
  for (std::string& line : lines) findings.push_back({Severity::Warning, std::move(line), ""});
}

std::string next_step(const DoctorOptions& options, const Recording& recording, bool ill) {
  if (ill) return "mend the errors above, then " + command_line("doctor", options.source);
  if (!recording.calibration)
    return "edged calib --new CAMERA --out head.yaml, then " + command_line("doctor", options.source) +
           " --calib head.yaml";
  return command_line("run", options.source);
}

/// For which a contradiction of the gyro counts. With less, corners on images of events may give a rotation or a time
/// offset far from a right calibration: 13 of 60 simulated flights with 1.8 s of motion did, 7 of 60 with 2.8.
Duration least_turning(Modality modality) { return std::chrono::seconds(modality == Modality::Events ? 3 : 1); }

int run_doctor(const DoctorOptions& options) {
  catch_interrupts();
  HeldWarnings held;
  const Recording recording = open_uncalibrated(options.source);
  std::vector<VisualTurns> visual;
  GyroIntegral gyro;
  AccelAxes axes;
  ExternalCheck external;
  const std::vector<CheckedCamera> cameras = cameras_to_check(recording);
  for (const CheckedCamera& checked : cameras) visual.emplace_back(checked.camera);
  StereoAgreement stereo(as_recorded(cameras));
  const SurveyRun read = survey_recording(*recording.dataset, options.quiet, [&](const Measurement& measurement) {
    if (const auto* sample = std::get_if<ImuSample>(&measurement)) gyro.add(*sample), axes.add(*sample);
    if (const auto* sample = std::get_if<ExternalSample>(&measurement)) external.add(*sample);
    stereo.add(measurement);
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (const std::string* camera = camera_of(measurement); camera && *camera == cameras[i].recorded)
        visual[i].add(measurement);
  });
  if (interrupt_signal() != 0) return exit_code_of_interrupt();

  std::vector<CameraCheck> checks;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const RigCamera& camera = cameras[i].camera;
    const std::vector<Turn>& turns = visual[i].turns();
    checks.push_back({camera, recording.calibration->has_extrinsics, compare_with_gyro(turns, gyro, camera.time_offset),
                      other_clock_rate(turns, gyro, camera.time_offset, read.survey.imu_span_ratio()),
                      least_turning(camera.modality)});
    if (const auto& found = checks.back().agreement)
      checks.back().lens = better_lens(camera, turns, gyro, found->unexplained);
  }
  std::vector<Finding> findings = check_recording(
      {read.survey, recording.calibration.has_value(), std::move(checks), false, axes.better(),
       recording.calibration ? recording.calibration->known_noise() : std::nullopt, stereo.exchanged()});
  external.judge(gyro, read.survey.external, findings);
  if (read.survey.events.count + read.survey.frames.count == 0)
    if (const auto start_s = cameras_start_after_s(options.source)) findings = {cameras_start_later(*start_s)};
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
