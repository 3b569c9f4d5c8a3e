// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The flags of SourceOptions, and the command line that repeats them.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "common/command.hpp"
#include "common/source.hpp"
#include "common/text.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/io/core/topic_choice.hpp"
#include "edged/io/text/sample_files.hpp"

namespace edged {

void add_reading_options(CLI::App& command, SourceOptions& options) {
  CLI::Option* rig = command.add_option("--rig", options.rig, "Name of a calibration that ships with the program");
  command.add_option("--calib", options.calib, "Calibration file or folder")->excludes(rig);
  command.add_option("--geometry", options.geometry,
                     "Size of the event sensor, WIDTHxHEIGHT [px], for files that do not contain it");
  command.add_option("--time-unit", options.time_unit, "Unit of the timestamps in a plain event file [detected]")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  command
      .add_option("--imu-clock-rate", options.imu_clock_rate,
                  "Speed of the IMU's clock relative to the other clocks, as `edged doctor` reports: its stamps are "
                  "corrected from the first one on")
      ->check(CLI::Range(0.1, 10.0));
  command.add_option(
      "--imu-time-offset", options.imu_time_offset,
      "Seconds to add to all stamps of the IMU, which has an epoch of its own, -4e9 to 4e9, or auto: found, with its "
      "drift, by the rotation of camera and gyro in the whole recording, which is read once more [none]");
  command
      .add_option(
          "--topic", options.topics,
          fmt::format("Topic of a ROS bag or stream of AEDAT4 as ROLE=NAME: {}, or the name of a camera; NAME none "
                      "leaves it out; may be repeated [of several cameras the topics in the calibration (rostopic), "
                      "else by name; else the only topic of a fitting type]",
                      fmt::join(kRoleNames, ", ")))
      ->allow_extra_args(false);
  command
      .add_option("--from,--start", options.piece.from_s, "Skip what comes earlier [s from the start of the recording]")
      ->check(non_negative_number());
  CLI::Option* to =
      command.add_option("--to", options.piece.to_s, "Stop at this time [s from the start of the recording]");
  to->check(non_negative_number());
  command.add_option("--duration", options.duration_s, "Stop this long after --from [s]")
      ->check(positive_number())
      ->excludes(to);
  command
      .add_option("--dim-frames", options.dim_frames,
                  "Darken the frames by this factor, with the noise of their camera: 0.06 leaves about 20 grey levels")
      ->check(CLI::Range(1e-3, 1.0))
      ->group("");  // for experiments
}

void add_cameras_option(CLI::App& command, SourceOptions& options, bool all) {
  options.all_cameras = all;
  command
      .add_option(
          "--cameras", options.cameras,
          fmt::format("Names of the cameras to read, separated by commas [{}]", all ? "all" : "the first of each kind"))
      ->delimiter(',')
      ->allow_extra_args(false);
}

void add_source_options(CLI::App& command, SourceOptions& options) {
  command
      .add_option("RECORDING", options.recording,
                  "Folder or file (the format is detected), tcp://HOST:PORT[,PORT...] of a DV server, or "
                  "sim:PRESET[:SEED][:KEY=VALUE,...] of the simulator")
      ->required();
  command.add_option("--imu", options.imu,
                     "IMU samples from a csv or txt on the recording's clock, instead of its own; columns and units by "
                     "the names in its first line, else found");
  for (const ExternalSensor& sensor : external_sensors())
    command.add_option(fmt::format("--{}", sensor.name), options.external[std::string(sensor.name)],
                       fmt::format("{}: samples from a csv or txt on the recording's clock, lines of `{}` or columns "
                                   "by the names in its first line",
                                   sensor.what, layout_of(sensor)));
  add_reading_options(command, options);
}

std::string command_line(const std::string& command, const SourceOptions& source) {
  std::string line = fmt::format("edged {} {}", command, shell_word(source.recording));
  const auto add = [&line](const std::string& name, const std::string& value) {
    if (!value.empty()) line += fmt::format(" {} {}", name, shell_word(value));
  };
  add("--rig", source.rig);
  add("--calib", source.calib.string());
  add("--imu", source.imu.string());
  if (source.imu_clock_rate != 1.0) add("--imu-clock-rate", fmt::format("{}", source.imu_clock_rate));
  add("--imu-time-offset", source.imu_time_offset);
  for (const auto& [name, file] : source.external) add("--" + name, file.string());
  add("--geometry", source.geometry);
  add("--time-unit", source.time_unit);
  if (!source.truth.empty()) add("--truth", source.truth.string());
  for (const std::string& topic : source.topics) add("--topic", topic);
  if (!source.cameras.empty()) {
    const bool run = command == "run";
    add(run ? "--set" : "--cameras", fmt::format("{}{}", run ? "cameras=" : "", fmt::join(source.cameras, ",")));
  }
  if (source.piece.from_s > 0.0) add("--from", fmt::format("{}", source.piece.from_s));
  if (source.piece.to_s) add("--to", fmt::format("{}", *source.piece.to_s));
  if (source.duration_s) add("--duration", fmt::format("{}", *source.duration_s));
  if (source.dim_frames) add("--dim-frames", fmt::format("{}", *source.dim_frames));
  return line;
}

}  // namespace edged
