// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "source.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/recording.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

constexpr std::string_view kSimulatorPrefix = "sim:";

/// "room" or "room:7".
SimulatorConfig simulator_config(const std::string& text) {
  const std::size_t colon = text.find(':');
  SimulatorConfig config = simulator_preset(text.substr(0, colon));
  if (colon != std::string::npos) ConfigFields::of(config).set("seed", text.substr(colon + 1));
  return config;
}

/// What the user chose, if anything.
std::optional<Calibration> chosen_calibration(const SourceOptions& options) {
  if (!options.calib.empty()) return load_calibration(options.calib);
  if (!options.rig.empty()) return load_rig(options.rig);
  return std::nullopt;
}

std::string rig_list() {
  std::string list;
  for (const std::string& name : known_rigs()) list += (list.empty() ? "" : ", ") + name;
  return list;
}

RecordingOptions recording_options(const SourceOptions& options) {
  RecordingOptions chosen;
  if (!options.geometry.empty()) {
    chosen.geometry = parse_geometry(options.geometry);
    if (!chosen.geometry)
      throw InputError::format("--geometry {}: is no WIDTHxHEIGHT in pixels, such as 640x480", options.geometry);
  }
  for (const std::string& text : options.topics) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      throw InputError::format("--topic {}: write ROLE=NAME, such as events=/dvs/events", text);
    chosen.topics[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return chosen;
}

Source open_on_disk(const SourceOptions& options) {
  std::optional<Calibration> calibration = chosen_calibration(options);
  Recording recording =
      open_recording(options.recording, calibration ? &calibration->rig : nullptr, recording_options(options));
  if (!calibration) calibration = std::move(recording.calibration);
  if (!calibration) {
    throw InputError::format(
        "{}: brings no calibration of cameras and IMU; give --rig NAME (there are: {}) or --calib FILE",
        options.recording, rig_list());
  }
  if (!calibration->has_extrinsics) {
    throw InputError::format(
        "{}: holds intrinsics only; the pose of the camera to the IMU and the time offset are missing",
        options.calib.string());
  }
  if (!calibration->has_imu_noise) spdlog::warn("the calibration holds no IMU noise; defaults are used");
  return {std::move(recording.dataset), std::move(*calibration), std::nullopt};
}

}  // namespace

void add_source_options(CLI::App& command, SourceOptions& options) {
  command.add_option("RECORDING", options.recording, "Folder or file (format found by content), or sim:PRESET[:SEED]")
      ->required();
  CLI::Option* rig = command.add_option("--rig", options.rig, "Calibration that ships with the program, by name");
  command.add_option("--calib", options.calib, "Calibration file or folder")->excludes(rig);
  command.add_option("--geometry", options.geometry,
                     "WIDTHxHEIGHT [px] of the event sensor, for files that do not hold it");
  command
      .add_option(
          "--topic", options.topics,
          "Topic of a ROS bag as ROLE=NAME: events, frames, imu or truth; NAME none leaves it out; may be repeated "
          "[the only topic of a fitting type]")
      ->allow_extra_args(false);
}

Source open_source(const SourceOptions& options) {
  if (!options.recording.starts_with(kSimulatorPrefix)) return open_on_disk(options);
  const SimulatorConfig config = simulator_config(options.recording.substr(kSimulatorPrefix.size()));
  auto simulator = std::make_unique<Simulator>(config);
  Calibration calibration = chosen_calibration(options).value_or(simulator->calibration());
  return {std::move(simulator), std::move(calibration), config.seed};
}

}  // namespace edged
