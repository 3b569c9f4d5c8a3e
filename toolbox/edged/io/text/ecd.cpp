// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The text folders of the Event-Camera Dataset (Mueggler et al., IJRR 2017).
#include "edged/io/text/ecd.hpp"

#include <array>

#include "edged/core/check.hpp"
#include "edged/io/calibration_source.hpp"
#include "edged/io/dataset_folders.hpp"
#include "edged/io/geometry.hpp"
#include "edged/io/text/text_dataset.hpp"
#include "edged/io/trajectory_io.hpp"

namespace edged {
namespace {

/// `t ax ay az gx gy gz`: acceleration first.
std::optional<ImuSample> parse_ecd_imu(std::string_view line) {
  FieldReader fields(line);
  const auto t = parse_seconds(fields.next());
  std::array<double, 6> v;
  if (!t || !read_numbers(fields, v) || !fields.rest().empty()) return std::nullopt;
  return ImuSample{*t, {v[3], v[4], v[5]}, {v[0], v[1], v[2]}};
}

std::optional<GroundTruth> read_ground_truth(const SourcePath& file, const std::string& camera, Repairs& repairs) {
  LineDamage damage(file.string(), "groundtruth", repairs);
  const auto count = [&](std::size_t line, const std::string& detail) { damage.bad(line, "bad line", detail); };
  GroundTruth truth{read_tum(file, count), camera};
  if (truth.trajectory.empty()) return std::nullopt;
  return truth;
}

cv::Size sensor_size(const SourcePath& folder, const Rig* rig, const std::optional<Calibration>& own) {
  for (const Rig* r : {rig, own ? &own->rig : nullptr})
    if (r)
      if (const RigCamera* camera = r->find(Modality::Events)) return {camera->model.width(), camera->model.height()};
  return ecd_image_size(folder).value_or(cv::Size(kEcdWidth, kEcdHeight));
}

}  // namespace

Recording open_ecd(const SourcePath& folder, const Rig* rig) {
  Recording recording;
  if (const SourcePath own = folder / "calibration.yaml"; own.is_file()) recording.calibration = read_calibration(own);
  // The lens of a sequence can differ from that of the rig: the data set used several.
  if (const SourcePath calib = folder / "calib.txt"; rig && calib.is_file())
    warn_of_other_lens(calib.string(), read_calibration(calib).rig.cameras.front().model.mean_focal(), *rig,
                       Modality::Events);

  TextLayout layout;
  layout.info.name = folder.name();
  layout.info.format = "ecd";
  layout.parse_stamp = parse_seconds;
  if (const SourcePath events = folder / "events.txt"; events.is_file()) {
    const cv::Size size = sensor_size(folder, rig, recording.calibration);
    layout.info.event_sensor = size;
    layout.events = EventFile{events, "events", size.width, size.height};
  }
  if ((folder / "images.txt").is_file()) layout.frames = {{"frames", ecd_images(folder)}};
  if (const SourcePath imu = folder / "imu.txt"; imu.is_file())
    layout.imu = {imu, "imu", "t ax ay az gx gy gz", LastLine::MustEnd, parse_ecd_imu};
  if (const SourcePath truth = folder / "groundtruth.txt"; truth.is_file()) {
    const bool no_event_camera = recording.calibration && !recording.calibration->rig.find(Modality::Events);
    layout.info.pose_frame = no_event_camera ? "frames" : "events";
    layout.ground_truth = [truth, camera = layout.info.pose_frame](Repairs& repairs) {
      return read_ground_truth(truth, camera, repairs);
    };
  }
  recording.dataset = std::make_unique<TextDataset>(std::move(layout));
  return recording;
}

}  // namespace edged
