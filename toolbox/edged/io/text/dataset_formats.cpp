// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The text folders of the Event-Camera Dataset (Mueggler et al., IJRR 2017), and the ASL folders of the EuRoC data set
// (Burri et al., IJRR 2016), which TUM-VI (Schubert et al., IROS 2018) uses too.
#include "edged/io/text/dataset_formats.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/io/text/event_text.hpp"
#include "edged/io/text/text_dataset.hpp"

namespace edged {
namespace {

/// UZH-FPV (Delmerico et al., ICRA 2019) has the same layout with a first column `id`, and ground truth of the IMU.
bool is_uzh_fpv(const SourcePath& folder) {
  for (const char* name : {"groundtruth.txt", "imu.txt"}) {
    const SourcePath file = folder / name;
    if (!file.is_file()) continue;
    const std::vector<ColumnName> names = last_heading(file);
    if (!names.empty() && has_word(names.front(), {"id"})) return true;
  }
  return false;
}

cv::Size sensor_size(const SourcePath& folder, const Rig* rig, const std::string& name) {
  if (const RigCamera* camera = rig ? find_camera(*rig, Modality::Events, name) : nullptr)
    return {camera->model.width(), camera->model.height()};
  return ecd_image_size(folder).value_or(cv::Size(kEcdWidth, kEcdHeight));
}

/// Names of the first camera of each kind, read or not.
struct FirstCameras {
  std::string events = "events", frames = "frames";
};

/// Adds the cameras of the folder that are read, with their names: events.txt, events2.txt and so on, and lists of
/// images.
FirstCameras add_cameras(TextLayout& layout, const SourcePath& folder, const Rig* rig,
                         const RecordingOptions& options) {
  const auto chosen = [&](Modality modality, const auto& find_file) {
    std::vector<std::string> files;
    for (auto file = find_file(0); file; file = find_file(files.size())) files.push_back(file->name());
    const NamedStreams named = name_streams(rig, modality, files, options.cameras, folder.string());
    if (!named.said.empty()) spdlog::warn(named.said);
    return std::pair(named.names, cameras_to_read(named.names, options.cameras, options.all_cameras));
  };
  const auto find_events = [&](std::size_t camera) -> std::optional<SourcePath> {
    const SourcePath file = folder / ("events" + ecd_number(camera) + ".txt");
    return file.is_file() ? std::optional(file) : std::nullopt;
  };
  const auto [events, read_events] = chosen(Modality::Events, find_events);
  for (const std::size_t i : read_events) {
    const SourcePath file = *find_events(i);
    const cv::Size size = sensor_size(folder, rig, events[i]);
    if (layout.events.empty()) layout.info.event_sensor = size;
    layout.events.push_back({file, events[i], size.width, size.height, named_event_columns(file)});
  }
  const auto [frames, read_frames] =
      chosen(Modality::Frames, [&](std::size_t camera) { return find_ecd_image_list(folder, camera); });
  for (const std::size_t i : read_frames) layout.frames.push_back({frames[i], ecd_images(folder, i)});
  return {events.empty() ? "events" : events.front(), frames.empty() ? "frames" : frames.front()};
}

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

Recording open_ecd(const SourcePath& folder, const Rig* rig, const RecordingOptions& options) {
  Recording recording;
  if (const SourcePath own = folder / "calibration.yaml"; own.is_file()) recording.calibration = read_calibration(own);
  // The lens of a sequence can differ from that of the rig, as the data set has several lenses.
  if (const SourcePath calib = folder / "calib.txt"; rig && calib.is_file())
    warn_of_other_lens(calib.string(), read_calibration(calib).rig.cameras.front().model.mean_focal(), *rig,
                       Modality::Events);

  TextLayout layout;
  layout.info.name = folder.name();
  layout.info.format = "ecd";
  const FirstCameras first =
      add_cameras(layout, folder, rig || !recording.calibration ? rig : &recording.calibration->rig, options);
  if (const SourcePath imu = folder / "imu.txt"; options.own_imu && imu.is_file()) {
    TextTable documented = accel_first(TimeUnit::Seconds);
    documented.exact = true;
    layout.imu = imu_lines(imu, documented_imu_table(imu, documented));
  }
  if (const SourcePath truth = folder / "groundtruth.txt"; truth.is_file()) {
    const bool no_event_camera = recording.calibration && !recording.calibration->rig.find(Modality::Events);
    layout.info.pose_frame = is_uzh_fpv(folder) ? "body" : no_event_camera ? first.frames : first.events;
    layout.ground_truth = [truth, camera = layout.info.pose_frame](Repairs& repairs) {
      return read_ground_truth(truth, tum_table(TimeUnit::Seconds), camera, repairs);
    };
  }
  recording.dataset = open_text(std::move(layout));
  return recording;
}

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
  recording.dataset = open_text(std::move(layout));
  return recording;
}

}  // namespace edged
