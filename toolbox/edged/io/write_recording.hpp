// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes any data set in any of the writable formats.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "edged/io/core/recording_writer.hpp"

namespace edged {

/// What a format holds besides events.
struct WritableContents {
  bool frames = false, imu = false, ground_truth = false, external = false;
  bool several_cameras = false;  ///< several cameras of a kind
};

struct WritableFormat : WritableContents {
  std::string_view name;        ///< "ecd"
  std::string_view extension;   ///< with its dot; "" for a folder
  Duration tick = Duration(1);  ///< unit of the stamps of events
  std::unique_ptr<RecordingWriter> (*open)(const WriterSetup& setup) = nullptr;
};

std::span<const WritableFormat> writable_formats();

/// The format of that name. Without a name, the format of the extension of the path (no extension: a folder). Throws
/// InputError that lists the formats.
const WritableFormat& writable_format(std::string_view name, const std::filesystem::path& path);

struct WriteOptions {
  bool round = false;  ///< round down stamps that are finer than the tick of the format, instead of refusing them
  std::function<void(Timestamp)> progress = {};  ///< called repeatedly with the current stamp
};

/// Numbers of items that were written, and that were left out because the format cannot hold them.
struct WriteCounts {
  std::size_t events = 0, frames = 0, imu = 0, poses = 0;
  std::size_t frames_left_out = 0, imu_left_out = 0, poses_left_out = 0;
  std::map<std::string, std::size_t> external = {}, external_left_out = {};  ///< by the name of the sensor
};

/// ", 250 height samples"; "" for none.
std::string external_text(const std::map<std::string, std::size_t>& counts);

/// Reads `dataset` to its end and writes it. Each event reads back to the same bits. Throws InputError if `path`
/// is a file or already holds a recording, if it cannot be written, and for stamps of events that are finer than the
/// tick of the format.
WriteCounts write_recording(Dataset& dataset, const WritableFormat& format, const std::filesystem::path& path,
                            const std::optional<Calibration>& calibration, const WriteOptions& options = {});

}  // namespace edged
