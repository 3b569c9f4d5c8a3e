// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The ASL folders of the EuRoC data set (Burri et al., IJRR 2016), which TUM-VI (Schubert et al., IROS 2018) uses too.
#include "edged/io/text/dataset_formats.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/core/calibration_source.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/io/text/text_dataset.hpp"

namespace edged {
namespace {

/// Folders with poses of the body, of EuRoC and of TUM-VI.
constexpr const char* kTruthFolders[] = {"state_groundtruth_estimate0", "mocap0"};
/// Folders with the data from which the ground truth of EuRoC was computed: positions, poses of a marker.
constexpr const char* kRawTruthFolders[] = {"leica0", "vicon0"};

/// The wanted cameras that exist, or all that have images, in the order of their names; else the first camera.
std::set<std::string> find_cameras(const SourcePath& mav0, const RecordingOptions& options) {
  const auto is_there = [&](const std::string& camera) {
    return camera.starts_with("cam") && (mav0 / camera / "data.csv").is_file();
  };
  const auto has_images = [&](const std::string& camera) {
    return std::ranges::count((mav0 / camera).names(), "data") > 0 && !(mav0 / camera / "data").names().empty();
  };
  std::set<std::string> cameras;
  for (const std::string& camera : options.all_cameras ? mav0.names() : options.cameras)
    if (is_there(camera) && (!options.all_cameras || has_images(camera))) cameras.insert(camera);
  if (cameras.empty() && is_there("cam0")) cameras.insert("cam0");
  return cameras;
}

/// The file with poses of the body. Warns if there is only ground truth of another kind.
std::optional<SourcePath> find_truth(const SourcePath& mav0) {
  for (const char* folder : kTruthFolders)
    if (const SourcePath file = mav0 / folder / "data.csv"; file.is_file()) return file;
  for (const char* folder : kRawTruthFolders)
    if ((mav0 / folder / "data.csv").is_file())
      spdlog::warn(
          fmt::format("{}: holds no poses of the body and is not read as ground truth", (mav0 / folder).string()));
  return std::nullopt;
}

/// The calibration of the folder. An unreadable one is ignored with a warning.
std::optional<Calibration> tum_vi_calibration(const SourcePath& mav0) try {
  const SourcePath dso = mav0.parent_path() / "dso";
  return (dso / "camchain.yaml").is_file() ? std::optional(read_calibration(dso, {.otherwise = Sees::Frames}))
                                           : std::nullopt;
} catch (const InputError& error) {
  spdlog::warn(fmt::format("{}; opened without this calibration", error.what()));
  return std::nullopt;
}

/// The layout with all cameras that are read.
Calibration calibration_of(const SourcePath& mav0, const std::set<std::string>& cameras) {
  Calibration calibration = read_calibration(mav0);
  std::vector<RigCamera>& known = calibration.rig.cameras;
  for (const std::string& name : cameras) {
    const SourcePath sensor = mav0 / name / "sensor.yaml";
    if (std::ranges::find(known, name, &RigCamera::name) == known.end() && sensor.is_file())
      known.push_back(read_calibration(sensor).rig.cameras.front());
  }
  return calibration;
}

}  // namespace

Recording open_euroc(const SourcePath& mav0, const RecordingOptions& options) {
  TextLayout layout;
  layout.info.name = (mav0.name() == "mav0" ? mav0.parent_path() : mav0).name();
  layout.info.format = "euroc";
  layout.info.pose_frame = "body";
  const std::set<std::string> read = find_cameras(mav0, options);
  for (const std::string& camera : read)
    layout.frames.push_back(
        {camera, image_lines(mav0 / camera / "data.csv", mav0 / camera / "data", TimeUnit::Nanoseconds)});
  if (const SourcePath imu = mav0 / "imu0" / "data.csv"; options.own_imu && imu.is_file())
    layout.imu = imu_lines(imu, documented_imu_table(imu, gyro_first(TimeUnit::Nanoseconds)));
  if (const auto truth = find_truth(mav0))
    layout.ground_truth = [file = *truth](Repairs& repairs) {
      return read_ground_truth(file, euroc_table(), "body", repairs);
    };

  Recording recording;
  if ((mav0 / "cam0" / "sensor.yaml").is_file()) {
    recording.calibration = calibration_of(mav0, read);
  } else {
    recording.calibration = tum_vi_calibration(mav0);
  }
  recording.dataset = std::make_unique<TextDataset>(std::move(layout));
  return recording;
}

}  // namespace edged
