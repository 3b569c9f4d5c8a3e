// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The text folders of the Event-Camera Dataset (Mueggler et al., IJRR 2017).
#include "edged/io/text/dataset_formats.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/core/calibration_source.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/core/geometry.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/io/text/event_csv.hpp"
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
  recording.dataset = std::make_unique<TextDataset>(std::move(layout));
  return recording;
}

}  // namespace edged
