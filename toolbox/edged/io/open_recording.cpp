// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which format a folder or a file is.
#include "edged/io/open_recording.hpp"

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat4.hpp"
#include "edged/io/aedat/aedat4_tcp.hpp"
#include "edged/io/bytes.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/hdf5/h5.hpp"
#include "edged/io/hdf5/hdf5_dataset.hpp"
#include "edged/io/prophesee/raw.hpp"
#include "edged/io/ros/open_messages.hpp"
#include "edged/io/ros/ros_dataset.hpp"
#include "edged/io/text/event_csv.hpp"
#include "edged/io/zip_archive.hpp"

namespace edged {
namespace {

/// Nothing where the folder is no recording.
std::optional<Recording> try_folder(const SourcePath& folder, const Rig* rig) {
  if (is_ecd_folder(folder)) return open_ecd(folder, rig);
  if (const auto mav0 = find_mav0(folder)) return open_euroc(*mav0);
  return std::nullopt;
}

Recording open_folder(const std::filesystem::path& folder, const Rig* rig, const RecordingOptions& options) {
  if (is_bag_folder(folder)) return open_bag(folder, rig, options);
  if (auto recording = try_folder(folder, rig)) return std::move(*recording);
  if (const auto file = find_hdf5_events(folder)) return open_hdf5(*file, rig, options.geometry);
  throw InputError::format(
      "{}: no recording found; looked for events.txt, images.txt or imu.txt (Event-Camera Dataset), for "
      "[mav0/]cam0/data.csv or [mav0/]imu0/data.csv (EuRoC), for .h5 or .hdf5 files, and for .db3 "
      "or .mcap files (ROS 2)",
      folder.string());
}

/// The archive is the folder of the recording, or holds it.
Recording open_archive(const std::filesystem::path& file, const Rig* rig) {
  const SourcePath top = SourcePath::in_archive(file);
  if (auto recording = try_folder(top, rig)) return std::move(*recording);
  std::optional<Recording> found;
  for (const std::string& name : top.names()) {
    auto recording = try_folder(top / name, rig);
    if (recording && found)
      throw InputError::format("{}: holds several recordings ({}, {}): unpack it and give one of them", file.string(),
                               found->dataset->info().name, recording->dataset->info().name);
    if (recording) found = std::move(recording);
  }
  if (found) return std::move(*found);
  throw InputError::format(
      "{}: no recording at the top of the archive or in one folder; looked for those of the Event-Camera Dataset "
      "(events.txt, images.txt, imu.txt) and EuRoC (mav0); unpack any other",
      file.string());
}

Recording open_file(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) {
  constexpr std::size_t kHeadBytes = 4096;
  const Bytes head = BinaryFile(file).read(0, kHeadBytes);
  if (is_bag(head)) return open_bag(file, rig, options);
  if (is_prophesee_file(head)) return open_prophesee(file, rig, options.geometry);
  if (is_zip(head)) return open_archive(file, rig);
  if (is_hdf5(head)) return open_hdf5(file, rig, options.geometry);
  if (is_aedat4(head)) return open_aedat4(file, rig, options);
  if (const auto form = find_event_form(file)) return open_event_csv(file, *form, rig, options);
  throw InputError::format(
      "{}: is no file that is known by its content; looked for ROS bags, Prophesee RAW, DAT, AEDAT4, HDF5, zip "
      "and text with an event in each line (`t x y p`, or columns named in the first line). Of a recording in several "
      "files give the folder (unpack an archive other than zip first)",
      file.string());
}

}  // namespace

Recording open_recording(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options) {
  std::error_code ignored;
  if (path.string().starts_with(kTcpPrefix)) return open_aedat4_tcp(path.string(), rig, options);
  if (!std::filesystem::exists(path, ignored)) throw InputError::format("{}: no such file or folder", path.string());
  return std::filesystem::is_directory(path, ignored) ? open_folder(path, rig, options) : open_file(path, rig, options);
}

}  // namespace edged
