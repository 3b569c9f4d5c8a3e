// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which format a folder or a file is.
#include "edged/io/recording.hpp"

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat4.hpp"
#include "edged/io/bytes.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/prophesee/raw.hpp"
#include "edged/io/ros/ros_dataset.hpp"

namespace edged {
namespace {

Recording open_folder(const std::filesystem::path& folder, const Rig* rig) {
  if (is_ecd_folder(folder)) return open_ecd(folder, rig);
  if (const auto mav0 = find_mav0(folder)) return open_euroc(*mav0);
  throw InputError::format(
      "{}: no recording found; looked for events.txt, images.txt or imu.txt (Event-Camera Dataset), for "
      "[mav0/]cam0/data.csv or [mav0/]imu0/data.csv (EuRoC) and for .db3 or .mcap files (ROS 2)",
      folder.string());
}

Recording open_file(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) {
  constexpr std::size_t kHeadBytes = 4096;
  const Bytes head = BinaryFile(file).read(0, kHeadBytes);
  if (is_prophesee_file(head)) return open_prophesee(file, rig, options.geometry);
  if (is_aedat4(head)) return open_aedat4(file, rig, options.geometry);
  throw InputError::format(
      "{}: is no file that is known by its content; looked for ROS bags, Prophesee RAW, DAT and AEDAT4. Of a recording "
      "in several files give the folder (unpack an archive first)",
      file.string());
}

}  // namespace

Recording open_recording(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError::format("{}: no such file or folder", path.string());
  if (is_bag(path))
    return {std::make_unique<RosDataset>(path, options.topics, rig, options.geometry), std::nullopt};
  return std::filesystem::is_directory(path, ignored) ? open_folder(path, rig) : open_file(path, rig, options);
}

}  // namespace edged
