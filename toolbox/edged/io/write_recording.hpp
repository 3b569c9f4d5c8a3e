// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writing of recordings: the formats there are, and any data set as any of them.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "edged/io/recording_writer.hpp"

namespace edged {

struct WritableFormat {
  std::string_view name;       ///< "ecd"
  std::string_view extension;  ///< of files, with its dot; "" for a folder
  bool frames = false, imu = false, ground_truth = false, external = false;  ///< held besides events
  Duration tick = Duration(1);                                               ///< stamps of events are multiples of it
  std::unique_ptr<RecordingWriter> (*open)(const WriterSetup& setup) = nullptr;
};

std::span<const WritableFormat> writable_formats();

/// The format of that name, or where it is empty that of the path's extension (none: a folder). Throws InputError that
/// lists the formats.
const WritableFormat& writable_format(std::string_view name, const std::filesystem::path& path);

struct WriteOptions {
  bool round = false;                            ///< stamps finer than the format's tick are cut to it, not refused
  std::function<void(Timestamp)> progress = {};  ///< called now and then with the stamp reached
};

/// Written, and left out as the format has no room for it.
struct WriteCounts {
  std::size_t events = 0, frames = 0, imu = 0, poses = 0;
  std::size_t frames_left_out = 0, imu_left_out = 0, poses_left_out = 0;
  std::map<std::string, std::size_t> external = {}, external_left_out = {};  ///< by the name of the sensor
};

/// ", 250 height samples"; "" where there are none.
std::string external_text(const std::map<std::string, std::size_t>& counts);

/// Reads `dataset` to its end and writes it. Read back, every event is the same to the last bit. Throws InputError
/// where something is at `path` already or cannot be written, and for stamps of events that the format is too coarse
/// for.
WriteCounts write_recording(Dataset& dataset, const WritableFormat& format, const std::filesystem::path& path,
                            const std::optional<Calibration>& calibration, const WriteOptions& options = {});

}  // namespace edged
