// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// RECORDING on the command line: a folder or file, or "sim:PRESET[:SEED]" for the simulator; with the calibration that
// fits it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/cli_fwd.hpp"
#include "edged/core/dataset.hpp"
#include "edged/core/recording_piece.hpp"
#include "edged/io/recording.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {

struct SourceOptions {
  std::string recording;
  std::string rig;              ///< name of a shipped rig; "" where not given
  std::filesystem::path calib;  ///< calibration file; "" where not given
  std::filesystem::path imu;    ///< file with IMU samples; "" where not given
  double imu_clock_rate = 1.0;  ///< seconds of the IMU's stamps to a second of the other sensors
  std::map<std::string, std::filesystem::path> external = {};  ///< files of external sensors, by their names
  std::string geometry;                   ///< "WIDTHxHEIGHT" of the event sensor; "" where not given
  std::string time_unit;                  ///< of plain event files: "s", "ms", "us" or "ns"; "" where not given
  std::vector<std::string> topics;        ///< of bags: ROLE=NAME
  std::vector<std::string> cameras = {};  ///< to read, by name, where the recording has several of a kind
  PieceBounds piece;
  std::optional<double> duration_s;  ///< of the piece, instead of its end
  std::optional<double> dim_frames;  ///< factor on the light of the frames
};

struct Source {
  std::unique_ptr<Dataset> dataset;
  Calibration calibration;
  std::optional<int> seed;  ///< of the simulator
};

/// Of "sim:PRESET[:SEED]"; nothing for another recording. Throws InputError for a preset that there is not.
std::optional<SimulatorConfig> simulator_config(const SourceOptions& options);

/// Adds --rig, --calib, --geometry, --time-unit, --imu-clock-rate, --topic, --from (also --start), --to, --duration and
/// --dim-frames.
void add_reading_options(CLI::App& command, SourceOptions& options);

/// Adds RECORDING, --imu, a flag for each external sensor, and these.
void add_source_options(CLI::App& command, SourceOptions& options);

/// With the calibration that was chosen, or which the recording brings, if any. Throws InputError when nothing can be
/// opened.
Recording open_uncalibrated(const SourceOptions& options);

/// Whether it is measured now, and who is too slow for it misses something.
bool is_live(const SourceOptions& options);

/// Of the recording, else of its calibration. Throws InputError where nothing tells.
cv::Size recording_event_sensor(const Recording& recording);

/// Throws InputError when nothing can be opened, or no calibration with extrinsics is at hand.
Source open_source(const SourceOptions& options);
/// The same of a recording that is open.
Source calibrated(const SourceOptions& options, Recording recording);

/// Calls the cameras that the mode needs as the recording does, and warns of what it had to assume for that. Throws
/// InputError where it cannot be known.
void match_cameras(Source& source, Mode mode);

}  // namespace edged
