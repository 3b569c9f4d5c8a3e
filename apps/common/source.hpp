// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens RECORDING of the command line, a folder, a file or "sim:PRESET[:SEED][:KEY=VALUE,...]" for the simulator, with
// its calibration.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/cli.hpp"
#include "edged/checks/finding.hpp"
#include "edged/checks/found_imu_clock.hpp"
#include "edged/core/measurements/recording_piece.hpp"
#include "edged/dataset.hpp"
#include "edged/io/recording.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {

struct SourceOptions {
  std::string recording;
  std::string rig;                   ///< name of a shipped rig; "" if not given
  std::filesystem::path calib;       ///< calibration file; "" if not given
  std::filesystem::path imu;         ///< file with IMU samples; "" if not given
  std::filesystem::path truth = {};  ///< file with the ground truth; "" if not given
  double imu_clock_rate = 1.0;       ///< seconds of the IMU clock per second of the other sensors
  std::string imu_time_offset;       ///< seconds to add to the stamps of the IMU, or "auto"; "" if not given
  /// What "auto" has found, by recording: it may be opened several times.
  std::shared_ptr<std::map<std::string, ChosenImuClock>> found_clocks =
      std::make_shared<std::map<std::string, ChosenImuClock>>();
  std::map<std::string, std::filesystem::path> external = {};  ///< files of external sensors, by their names
  std::string geometry;                                        ///< "WIDTHxHEIGHT" of the event sensor; "" if not given
  std::string time_unit;                  ///< of plain event files: "s", "ms", "us" or "ns"; "" if not given
  std::vector<std::string> topics;        ///< of bags: ROLE=NAME or CAMERA=NAME
  std::vector<std::string> cameras = {};  ///< names of cameras to read, if the recording has several of a modality
  bool all_cameras = false;               ///< reads all, if no names are given
  PieceBounds piece;
  std::optional<double> duration_s;  ///< length of the piece, instead of its end
  std::optional<double> dim_frames;  ///< factor on the light of the frames
};

/// The ground truth of a recording. A run continues without it if it is not usable.
struct OwnTruth {
  std::optional<GroundTruth> truth;
  std::string problem;  ///< why it is not usable; empty otherwise
};
OwnTruth read_truth(const Dataset& dataset);

struct Source {
  std::unique_ptr<Dataset> dataset;
  Calibration calibration;
  std::optional<int> seed;  ///< of the simulator
};

/// The configuration of "sim:PRESET[:SEED][:KEY=VALUE,...]". Nothing for another recording. Throws InputError for an
/// unknown preset or option.
std::optional<SimulatorConfig> simulator_config(const SourceOptions& options);

/// Adds --rig, --calib, --geometry, --time-unit, --imu-clock-rate, --imu-time-offset, --topic, --from (also --start),
/// --to, --duration and --dim-frames.
void add_reading_options(CLI::App& command, SourceOptions& options);

/// Adds RECORDING, --imu, a flag for each external sensor, and the options of add_reading_options().
void add_source_options(CLI::App& command, SourceOptions& options);

/// Adds --cameras. all: without it all cameras are read, else the first of each kind.
void add_cameras_option(CLI::App& command, SourceOptions& options, bool all = true);

/// Opens the recording with the chosen calibration, else with that of the recording, if any. Throws InputError if it
/// cannot be opened.
Recording open_uncalibrated(const SourceOptions& options);

/// What --imu-time-offset auto has found in the recording, which is open.
std::optional<ChosenImuClock> found_imu_clock(const SourceOptions& options);

/// True for a live source, of which a slow reader loses data.
bool is_live(const SourceOptions& options);

/// The size of the event sensor, from the recording, else from its calibration. Throws InputError if it is unknown.
cv::Size recording_event_sensor(const Recording& recording);

/// Opens the recording. Throws InputError if that fails, and without a calibration with extrinsics.
Source open_source(const SourceOptions& options);
/// A recording that is open already, as of open_source().
Source calibrated(const SourceOptions& options, Recording recording);

/// The command line `edged COMMAND RECORDING` with the options for reading the recording.
std::string command_line(const std::string& command, const SourceOptions& source);

/// Time of the first event or frame [s from the start of the recording], if the chosen piece ends before it. Reads the
/// recording again.
std::optional<double> cameras_start_after_s(const SourceOptions& options);

/// The finding for cameras that start late, and the time at which a run should start [s].
Finding cameras_start_later(double start_s);
double later_start_s(double start_s);

/// The ground truth of the recording; one of a camera that the calibration lacks is not usable. To be read after
/// match_cameras().
OwnTruth read_truth(const Source& source);

/// Renames the cameras that the mode or the ground truth needs to their names in the recording, with a warning for each
/// assumption. Throws InputError if that is ambiguous, or if the recording lacks one of the wanted cameras that the
/// calibration has.
void match_cameras(Source& source, Mode mode, const std::vector<std::string>& wanted = {});

}  // namespace edged
