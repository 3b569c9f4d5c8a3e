// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib/calib.hpp"

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/target_result.hpp"
#include "common/command.hpp"
#include "common/files.hpp"
#include "common/interrupt.hpp"
#include "common/status_line.hpp"
#include "common/text.hpp"
#include "edged/calibrate/collector.hpp"
#include "edged/calibrate/imu_start.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/target/print.hpp"

namespace edged {
namespace {

TargetSpec spec_of(const TargetOptions& given) {
  const auto kind = parse_target_kind(given.kind);
  EDGED_CHECK(kind.has_value(), "target '{}'", given.kind);
  TargetSpec spec = usual_target(*kind);
  if (given.rows) spec.rows = *given.rows;
  if (given.columns) spec.columns = *given.columns;
  if (given.size_mm) spec.size_m = 1e-3 * *given.size_mm;
  if (given.ratio) spec.ratio = *given.ratio;
  spec.validate();
  return spec;
}

std::vector<std::string> lens_names() {
  std::vector<std::string> out{"auto"};
  for (const LensModel& lens : lens_models()) out.emplace_back(lens.name);
  return out;
}

void show_progress(StatusLine& status, const Measurement& at, const DatasetInfo& info, const ViewCollector& collector) {
  if (const auto t = last_stamp(at))
    status.show(progress_text(*t, info, "searched") + "; target in " + collector.progress(), share_done(*t, info));
}

/// Reads the recording once, with the views found so far in the status line.
void collect(Dataset& dataset, ViewCollector& collector, StatusLine& status) {
  InterruptibleDataset recording(dataset);
  while (const std::optional<Measurement> measurement = recording.next()) {
    collector.add(*measurement);
    if (status.due()) show_progress(status, *measurement, dataset.info(), collector);
  }
  collector.finish();
}

std::map<std::string, cv::Size> event_sensors(const Recording& recording) {
  std::map<std::string, cv::Size> sensors;
  for (const RecordedCamera& camera : recorded_cameras(recording.dataset->info()))
    if (camera.modality == Modality::Events)
      sensors[camera.name] = camera.sensor.area() > 0 ? camera.sensor : recording_event_sensor(recording);
  return sensors;
}

/// Throws InputError for a name that the recording does not have.
void check_cameras(const std::vector<std::string>& wanted, const DatasetInfo& info) {
  const std::vector<RecordedCamera> recorded = recorded_cameras(info);
  for (const std::string& name : wanted) {
    if (std::ranges::find(recorded, name, &RecordedCamera::name) != recorded.end()) continue;
    throw InputError::format("--cameras {}: {} has {}", name, info.name, recorded_camera_names(info));
  }
}

CollectorOptions collector_options(const CalibOptions& options, const Recording& recording) {
  CollectorOptions out;
  out.frames = options.mode != "events";
  out.events = options.mode != "frames" && recording.dataset->info().has_events;
  if (out.events) out.event_sensors = event_sensors(recording);
  if (!out.events) recording.dataset->leave_out(Modality::Events);
  if (!out.frames) recording.dataset->leave_out(Modality::Frames);
  return out;
}

/// The lens of each camera; throws what is missing of all of them in one line.
void fit_lenses(TargetCalibration& result, const std::vector<TargetViews>& cameras, const ViewCollector& collector,
                const std::string& lens, StatusLine& status) {
  std::string needed;
  for (const TargetViews& views : cameras) {
    status.show(fmt::format("lens of {} from {}", views.name, quantity(views.views.size(), "view")));
    LensFit fit = lens == "auto" ? fit_best_lens(views, collector.layout())
                                 : fit_lens(views, collector.layout(), find_lens_model(lens)->model);
    result.coverage.push_back(coverage_of(views, fit, collector.layout()));
    const MissingViews missing = missing_views(views, fit, result.coverage.back());
    for (const std::string& line : missing.needed) needed += (needed.empty() ? "" : "; ") + line;
    result.advice.insert(result.advice.end(), missing.advised.begin(), missing.advised.end());
    result.cameras.push_back({views, std::move(fit)});
  }
  if (!needed.empty()) throw InputError("too little for a calibration: " + needed);
}

/// The rotations between views, in pieces of 10 s, over which a drift shows.
std::vector<std::vector<Turn>> turns_of(const TargetCamera& camera) {
  constexpr Duration kPiece = std::chrono::seconds(10);
  std::vector<std::vector<Turn>> pieces;
  for (const ViewTurn& turn : view_turns(camera.views, camera.lens.T_C_T)) {
    if (pieces.empty() || turn.end - pieces.back().front().begin > kPiece) pieces.emplace_back();
    pieces.back().push_back({turn.begin, turn.end, turn.angle_C});
  }
  return pieces;
}

/// The samples on the clock of the cameras, which the rotations of one of them determine. rate: of --imu-clock-rate,
/// by which they are corrected already.
std::vector<ImuSample> with_found_clock(std::vector<ImuSample> imu, double rate, TargetCalibration& result) {
  std::optional<ImuOffset> found;
  for (const TargetCamera& camera : result.cameras) {
    found = find_imu_offset(turns_of(camera), imu, {camera.views.name, camera.views.modality, {}, {}, {}}, false);
    if (found->determined()) break;
  }
  if (!found->determined()) throw undetermined_offset(result.recording, result.cameras.back().views.name, *found);
  result.imu_clock = {{found->offset, rate * found->rate}, found};
  const ClockLine left = ImuClock{found->offset, found->rate}.from(imu.front().t);
  for (ImuSample& sample : imu) sample.t = left.at(sample.t);
  return imu;
}

std::filesystem::path beside(const std::filesystem::path& out, const std::string& end) {
  std::filesystem::path path = out;
  return path.replace_filename(out.stem().string() + end);
}

/// --out in the format that was asked for; of OpenCV's one file a camera. Returns what has been written.
std::vector<std::string> write_calibration(const CalibOptions& options, const Calibration& calibration) {
  if (options.target.format == "kalibr") {
    write_file(options.out, to_kalibr_yaml(calibration, true));
  } else if (options.target.format == "opencv") {
    std::vector<std::string> files;
    for (const RigCamera& camera : calibration.rig.cameras) {
      const bool alone = calibration.rig.cameras.size() == 1;
      const auto file = alone ? options.out : beside(options.out, "_" + camera.name + options.out.extension().string());
      write_file(file, to_opencv_yaml(camera));
      files.push_back(file.string());
    }
    return files;
  } else {
    write_file(options.out, to_yaml(calibration));
  }
  return {options.out.string()};
}

void print_calibration(const CalibOptions& options, const TargetCalibration& result, const Calibration& calibration) {
  print_result(options.json, to_json(result), to_text(result));
  std::filesystem::path report = options.target.report;
  if (report.empty() && !options.out.empty()) report = beside(options.out, ".html");
  if (!report.empty()) write_file(report, target_page(result));
  if (options.out.empty()) return;
  const std::vector<std::string> files = write_calibration(options, calibration);
  if (options.json) return;
  fmt::print("{:<11} {}, {}\n", "written", fmt::join(files, ", "), report.string());
  if (!result.fit.has_imu && result.cameras.size() > 1 && options.target.format == "edged")
    fmt::print(
        "{:<11} the poses of the cameras to each other are not in this file, as it has them to the IMU: --format "
        "kalibr\n",
        "note");
  if (result.fit.has_imu && options.target.format != "opencv")
    fmt::print("{:<11} edged calib {} --check RECORDING\n", "next", shell_word(files.front()));
}

}  // namespace

void add_target_options(CLI::App& calib, TargetOptions& options) {
  calib
      .add_option("--target", options.kind,
                  "Instead: FILE is a recording of this target, from which lenses, poses and clocks of all cameras are "
                  "calibrated, and the IMU's")
      ->check(CLI::IsMember({"checkerboard", "aprilgrid", "charuco"}));
  calib.add_option("--rows", options.rows,
                   "Of the target: of tags, of inner corners of a checkerboard, of squares of a charuco [6]");
  calib.add_option("--columns", options.columns, "Of the target, likewise [6, 9 of a checkerboard, 8 of a charuco]");
  calib.add_option(
      "--size", options.size_mm,
      "Of the target: side of a tag or square as it was measured [mm] [50, 30 of a checkerboard, 40 of a charuco]");
  calib.add_option(
      "--ratio", options.ratio,
      "Of the target: gap over side of a tag (Kalibr's tagSpacing) [0.3]; charuco: marker over square [0.75]");
  calib
      .add_option("--lens", options.lens,
                  "With --target: model of the lenses; auto: radtan, or equidistant where it leaves a fifth less")
      ->check(CLI::IsMember(lens_names()))
      ->capture_default_str();
  calib
      .add_option("--format", options.format, "Of --out with --target: edged, kalibr (camchain) or opencv (intrinsics)")
      ->check(CLI::IsMember({"edged", "kalibr", "opencv"}))
      ->capture_default_str();
  calib.add_option("--cameras", options.cameras, "With --target: cameras to read, such as cam0,cam1 [all]")
      ->delimiter(',')
      ->allow_extra_args(false);
  calib.add_flag("--no-imu", options.no_imu, "With --target: without the IMU, cameras alone");
  calib.add_option("--report", options.report, "With --target: page with coverage and residuals [beside --out]");
}

int print_target(const CalibOptions& options) {
  const TargetOptions& target = options.target;
  const std::filesystem::path& file = target.print;
  if (target.kind.empty())
    throw InputError("--print-target: choose the target with --target checkerboard, aprilgrid or charuco");
  const std::string ending = file.extension().string();
  if (ending != ".svg" && ending != ".pdf")
    throw InputError::format("--print-target {}: must end with .svg or .pdf", file.string());
  const TargetSpec spec = spec_of(target);
  const TargetLayout layout = layout_of(spec);
  write_file(file, ending == ".svg" ? target_svg(spec) : target_pdf(spec));
  fmt::print("{}: {}, {:.0f} x {:.0f} mm; print it at 100 %, measure it, and give the measured --size\n", file.string(),
             describe(spec), 1e3 * layout.width, 1e3 * layout.height);
  return kExitOk;
}

int calibrate_from_target(const CalibOptions& options) {
  catch_interrupts();
  const auto begin = std::chrono::steady_clock::now();
  if (!options.out.empty()) check_writable(options.out, "--out");
  TargetCalibration result;
  result.target = spec_of(options.target);
  SourceOptions source = options.source_of_file();
  source.cameras = options.target.cameras;
  source.all_cameras = source.cameras.empty();
  const bool find_clock = source.imu_time_offset == "auto";
  if (find_clock) source.imu_time_offset = "0";  // its own clock, until the lens is known
  const Recording recording = open_uncalibrated(source);
  result.recording = recording.dataset->info().name;
  check_cameras(source.cameras, recording.dataset->info());
  StatusLine status(options.quiet);
  ViewCollector collector(result.target, collector_options(options, recording));
  collect(*recording.dataset, collector, status);
  // Ctrl-C ends a live recording, which is calibrated, and breaks off another.
  if (interrupt_signal() != 0 && !is_live(source)) return exit_code_of_interrupt();
  const std::vector<TargetViews> cameras = collector.cameras();
  if (cameras.empty())
    throw InputError::format("{}: there are no pictures and no events; check --mode and --cameras", result.recording);
  fit_lenses(result, cameras, collector, options.target.lens, status);
  const bool known_noise = recording.calibration && recording.calibration->has_imu_noise;
  const ImuNoise noise = known_noise ? recording.calibration->imu : ImuNoise();
  std::vector<ImuSample> imu;
  if (!options.target.no_imu) imu = collector.imu();
  if (find_clock && !imu.empty()) imu = with_found_clock(std::move(imu), source.imu_clock_rate, result);
  const RigFitOptions rig_options{.progress = [&status](int round) {
    status.show(fmt::format("all cameras, motion and IMU: round {}", round + 1));
  }};
  result.fit = fit_rig(result.cameras, collector.layout(), imu, noise, rig_options);
  status.clear();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::string name = options.out.empty() ? result.recording : options.out.stem().string();
  print_calibration(options, result, to_calibration(result, name, known_noise ? &noise : nullptr));
  return kExitOk;
}

}  // namespace edged
