// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/source.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "common/config_source.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/reading.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/replaced_streams.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/text/sample_files.hpp"
#include "edged/sim/dimmed_frames.hpp"
#include "edged/sim/simulated_pair.hpp"

namespace edged {
namespace {

constexpr std::string_view kSimulatorPrefix = "sim:";
constexpr std::string_view kMakesCalibration = "`edged calib --target` makes (docs/your-recording.md)";

/// The calibration chosen by the user, if any.
std::optional<Calibration> chosen_calibration(const SourceOptions& options) {
  if (!options.calib.empty()) return load_calibration(options.calib);
  if (!options.rig.empty()) return load_rig(options.rig);
  return std::nullopt;
}

/// ROLE=NAME of each --topic.
std::map<std::string, std::string> wanted_topics(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> topics;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      throw InputError::format("--topic {}: write ROLE=NAME, such as events=/dvs/events", text);
    const std::string role = text.substr(0, equals), name = text.substr(equals + 1);
    const auto [place, is_new] = topics.emplace(role, name);
    if (!is_new)
      throw InputError::format("--topic {}: {} is {} already: give each role and each camera once", text, role,
                               place->second);
  }
  return topics;
}

RecordingOptions recording_options(const SourceOptions& options, const std::optional<Calibration>& calibration) {
  RecordingOptions chosen;
  if (!options.geometry.empty()) {
    chosen.geometry = parse_geometry(options.geometry);
    if (!chosen.geometry)
      throw InputError::format("--geometry {}: is not WIDTHxHEIGHT in pixels, such as 640x480", options.geometry);
  }
  chosen.cameras = options.cameras;
  chosen.all_cameras = options.all_cameras && options.cameras.empty();
  if (calibration) chosen.camera_topics = calibration->topics;
  chosen.own_imu = options.imu.empty();
  chosen.imu_has_own_clock = !options.imu_time_offset.empty();
  chosen.interrupted = [] { return interrupt_signal() != 0; };
  if (!options.time_unit.empty()) chosen.time_unit = parse_time_unit(options.time_unit);
  chosen.topics = wanted_topics(options.topics);
  return chosen;
}

/// Opens the recording with the chosen calibration, else with that of the recording, if any.
Recording open_whole(const SourceOptions& options) {
  std::optional<Calibration> calibration = chosen_calibration(options);
  if (const std::optional<SimulatorConfig> config = simulator_config(options)) {
    const auto opened = [&](auto simulator) -> Recording {
      if (!calibration) calibration = simulator->calibration();
      return {std::move(simulator), std::move(calibration)};
    };
    const bool both = std::ranges::any_of(options.cameras, [](const std::string& name) { return name.ends_with('2'); });
    if (both) return opened(std::make_unique<SimulatedPair>(*config));
    return opened(std::make_unique<Simulator>(*config));
  }
  Recording recording = open_recording(options.recording, calibration ? &calibration->rig : nullptr,
                                       recording_options(options, calibration));
  if (calibration) recording.calibration = std::move(calibration);
  return recording;
}

/// Adds the sensor files that the user gave.
Recording open_with_files(const SourceOptions& options) {
  Recording recording = open_whole(options);
  if (!options.imu.empty())
    recording.dataset = with_imu_file(std::move(recording.dataset), options.imu, !options.imu_time_offset.empty());
  if (!options.truth.empty()) recording.dataset = with_truth_file(std::move(recording.dataset), options.truth);
  for (const auto& [name, file] : options.external)
    if (!file.empty())
      recording.dataset = with_external_file(std::move(recording.dataset), *find_external_sensor(name), file);
  return recording;
}

/// open_with_files() once more, without its warnings.
Recording open_again(const SourceOptions& options) {
  HeldWarnings said;
  Recording recording = open_with_files(options);
  said.take();
  return recording;
}

std::optional<double> given_offset_s(const SourceOptions& options) {
  return options.imu_time_offset.empty() ? 0.0 : given_imu_offset_s(options.imu_time_offset);
}

ChosenImuClock chosen_imu_clock(const SourceOptions& options) {
  const double rate = options.imu_clock_rate;
  if (const auto seconds = given_offset_s(options)) return {{duration_from_seconds(*seconds), rate}, std::nullopt};
  if (const auto known = found_imu_clock(options)) return *known;
  const auto read = [](Dataset& dataset, const std::function<void(const Measurement&)>& use) {
    read_through(dataset, false, "read for the IMU's clock", [&](const Measurement& m) { return use(m), true; });
    return interrupt_signal() == 0;
  };
  const ChosenImuClock found = determine_imu_clock([&] { return open_again(options); }, read, rate);
  if (found.found) options.found_clocks->insert({options.recording, found});
  return found;
}

/// The ground truth is of the recording's first camera of this kind, and the calibration has one of the kind to match.
bool is_of_truth(const Source& source, Modality modality) {
  const DatasetInfo& info = source.dataset->info();
  const auto is_kind = [modality](const RigCamera& camera) { return camera.modality == modality; };
  return info.pose_frame == (modality == Modality::Events ? info.event_camera : info.frame_camera) &&
         std::ranges::count_if(source.calibration.rig.cameras, is_kind) == 1;
}

}  // namespace

std::optional<ChosenImuClock> found_imu_clock(const SourceOptions& options) {
  const auto found = options.found_clocks->find(options.recording);
  return found == options.found_clocks->end() ? std::nullopt : std::optional(found->second);
}

std::optional<SimulatorConfig> simulator_config(const SourceOptions& options) {
  if (!options.recording.starts_with(kSimulatorPrefix)) return std::nullopt;
  const std::vector<std::string> parts = split(options.recording.substr(kSimulatorPrefix.size()), ":");
  SimulatorConfig config = simulator_preset(parts.front());
  for (const std::string& part : std::span(parts).subspan(1))
    assign(config, part.find('=') == std::string::npos ? std::vector{"seed=" + part} : split(part, ","));
  return config;
}

Recording open_uncalibrated(const SourceOptions& options) {
  const bool other_clock = options.imu_clock_rate != 1.0 || !options.imu_time_offset.empty();
  Recording recording = open_with_files(options);
  if (other_clock && is_live(options)) {
    recording = with_live_imu_clock(std::move(recording), given_offset_s(options), options.imu_clock_rate);
  } else if (other_clock) {
    const ImuClock clock = chosen_imu_clock(options).clock;
    recording.dataset = with_imu_clock(std::move(recording.dataset), open_again(options).dataset, clock);
  }
  PieceBounds piece = options.piece;
  if (options.duration_s) piece.to_s = piece.from_s + *options.duration_s;
  if (piece.from_s > 0.0 || piece.to_s)
    recording.dataset = std::make_unique<RecordingPiece>(std::move(recording.dataset), piece);
  if (options.dim_frames)
    recording.dataset = std::make_unique<DimmedFrames>(std::move(recording.dataset), *options.dim_frames);
  return recording;
}

bool is_live(const SourceOptions& options) { return options.recording.starts_with(kTcpPrefix); }

cv::Size recording_event_sensor(const Recording& recording) {
  const DatasetInfo& info = recording.dataset->info();
  if (!info.event_sensor.empty()) return info.event_sensor;
  const RigCamera* camera = recording.calibration ? recording.calibration->rig.find(Modality::Events) : nullptr;
  if (!camera)
    throw InputError::format("{}: does not contain the size of its event sensor; give --geometry WIDTHxHEIGHT",
                             info.name);
  return {camera->model.width(), camera->model.height()};
}

Source open_source(const SourceOptions& options) { return calibrated(options, open_uncalibrated(options)); }

Source calibrated(const SourceOptions& options, Recording recording) {
  if (!recording.calibration)
    throw InputError::format(
        "{}: has no calibration of cameras and IMU; give --rig NAME (there are: {}) or --calib FILE, which {}",
        options.recording, fmt::join(known_rigs(), ", "), kMakesCalibration);
  if (!recording.calibration->has_extrinsics)
    throw InputError::format(
        "{}: holds intrinsics only; the pose of the camera to the IMU and the time offset are missing: give --rig NAME "
        "or --calib FILE, which {}",
        options.calib.empty() ? options.recording : options.calib.string(), kMakesCalibration);
  if (!recording.calibration->has_imu_noise)
    spdlog::warn(
        "the calibration holds no IMU noise; defaults are used: `edged calib FILE --imu imu.yaml --out head.yaml` adds "
        "it");
  std::optional<int> seed;
  if (const std::optional<SimulatorConfig> config = simulator_config(options)) seed = config->seed;
  return {std::move(recording.dataset), std::move(*recording.calibration), seed};
}

OwnTruth read_truth(const Dataset& dataset) try { return {dataset.ground_truth(), ""}; } catch (const InputError& e) {
  return {std::nullopt, e.what()};
}

OwnTruth read_truth(const Source& source) {
  OwnTruth own = read_truth(*source.dataset);
  if (!own.truth || own.truth->frame == "body") return own;
  const std::vector<RigCamera>& cameras = source.calibration.rig.cameras;
  if (std::ranges::find(cameras, own.truth->frame, &RigCamera::name) != cameras.end()) return own;
  return {std::nullopt, fmt::format("{}: is of camera '{}', which calibration {} lacks", source.dataset->info().name,
                                    own.truth->frame, source.calibration.rig.name)};
}

std::optional<double> cameras_start_after_s(const SourceOptions& options) {
  if ((!options.duration_s && !options.piece.to_s) || is_live(options)) return std::nullopt;
  const double end_s = options.duration_s ? options.piece.from_s + *options.duration_s : *options.piece.to_s;
  const Recording recording = open_whole(options);
  std::optional<Timestamp> begin = recording.dataset->info().begin;
  while (const std::optional<Measurement> measurement = recording.dataset->next()) {
    const std::optional<Timestamp> first = first_stamp(*measurement);
    if (!begin) begin = first;
    if (interrupt_signal() != 0) break;
    if (!first || camera_of(*measurement) == nullptr) continue;
    const double start_s = to_seconds(*first - *begin);
    return start_s >= end_s ? std::optional(start_s) : std::nullopt;
  }
  return std::nullopt;
}

double later_start_s(double start_s) { return std::floor(10.0 * start_s) / 10.0; }

Finding cameras_start_later(double start_s) {
  return {Severity::Error, fmt::format("cameras start at {:.1f} s", start_s),
          fmt::format("use --start {:g}", later_start_s(start_s))};
}

void match_cameras(Source& source, Mode mode, const std::vector<std::string>& wanted) {
  const std::vector<RecordedCamera> recorded = recorded_cameras(source.dataset->info());
  for (const RigCamera& camera : source.calibration.rig.cameras) {
    const bool is_wanted = std::ranges::find(wanted, camera.name) != wanted.end() && uses(mode, camera.modality);
    if (!is_wanted || std::ranges::find(recorded, camera.name, &RecordedCamera::name) != recorded.end()) continue;
    throw InputError::format(
        "{}: has no camera '{}', which the option cameras names; it has {}; for a bag, --topic {}=NAME assigns its "
        "topic",
        source.dataset->info().name, camera.name, recorded_camera_names(source.dataset->info()), camera.name);
  }
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    if (!uses(mode, modality) && !is_of_truth(source, modality)) continue;
    const std::string assumed = match_camera(source.calibration.rig, source.dataset->info(), modality);
    if (!assumed.empty()) spdlog::warn(assumed);
  }
}

}  // namespace edged
