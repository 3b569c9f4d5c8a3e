// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/snapshots.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/even_sample.hpp"
#include "common/files.hpp"
#include "common/json_text.hpp"
#include "common/pictures.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

constexpr int kWidest_px = 320;

/// The files of the report that are made from the steps, the ground truth and the estimated calibration.
class SnapshotFiles : public RunObserver {
 public:
  explicit SnapshotFiles(RunContext& run) : run_(run), snapshots_(run.products.get<Snapshots>()) {}
  void on_step(const Step& step) override { snapshots_.add(step); }
  void on_end(const RunEnd& end) override {
    const Calibration& given = run_.source.calibration;
    if (end.truth)
      if (const Trajectory poses = snapshots_.part_of_run(end.truth->trajectory); !poses.empty())
        write_tum(run_.folder / "groundtruth.tum", poses,
                  {"ground truth while the run lasted: " + OutputFrame(given.rig, end.truth->frame).describe()});
    write_file(run_.folder / "calibration_found.yaml", to_yaml(with_estimated(given, run_.rig)));
    write_file(run_.folder / "album.json",
               snapshots_.to_json(end.truth ? end.truth->frame : "", end.in_map_since).dump() + "\n");
  }

 private:
  const RunContext& run_;
  Snapshots& snapshots_;
};

}  // namespace

void Snapshots::add(const Step& step) {
  last_ = step.t;
  changes_.add(step);
  take_picture(step);
  if (step.keyframe) points_.add(step.landmarks);
}

bool Snapshots::is_due(Timestamp t, bool events, bool frame) {
  constexpr Duration kPatience = std::chrono::milliseconds(200);  // for a step with images of both cameras
  events_come_ |= events;
  frames_come_ |= frame;
  if (!events && !frame) return false;
  if (!due_) due_ = t;
  const bool complete = events == events_come_ && frame == frames_come_;
  return t >= (complete ? *due_ : *due_ + kPatience);
}

void Snapshots::take_picture(const Step& step) {
  const auto seen_by = [&step](Modality modality) {  // the first camera of the kind
    const CameraStep* camera = step.find(modality);
    return camera && !camera->image.empty() ? camera : nullptr;
  };
  const CameraStep *events = seen_by(Modality::Events), *frame = seen_by(Modality::Frames);
  if (!is_due(step.t, events != nullptr, frame != nullptr)) return;
  const auto picture = [](const CameraStep* camera) {
    return camera ? track_picture(camera->image, camera->tracks, kWidest_px) : std::vector<unsigned char>{};
  };
  pictures_.push_back({step.t, picture(events), picture(frame)});
  for (const CameraStep& camera : step.cameras)
    if (&camera != step.find(camera.modality) && !camera.image.empty())
      pictures_.back().others[camera.name] = picture(&camera);
  if (pictures_.size() > kMostPictures) {
    keep_every_second(pictures_);
    spacing_ *= 2;
  }
  due_ = pictures_.back().t + spacing_;
}

nlohmann::ordered_json Snapshots::to_json(const std::string& truth_frame, std::optional<Timestamp> in_map_since) const {
  nlohmann::ordered_json json = {{"truth_frame", truth_frame},
                                 {"in_map_since_ns", nullptr},
                                 {"changes", nlohmann::ordered_json::array()},
                                 {"points", nlohmann::ordered_json::array()},
                                 {"pictures", nlohmann::ordered_json::array()}};
  if (in_map_since) json["in_map_since_ns"] = to_ns(*in_map_since);
  for (const StatusChange& change : changes_.all()) {
    json["changes"].push_back({{"t_ns", to_ns(change.t)},
                               {"status", to_string(change.status)},
                               {"reason", change.reason},
                               {"relocalized", change.relocalized}});
  }
  for (const auto& [id, point] : points_.all()) {
    for (const float x : point) json["points"].push_back(std::round(1e3 * static_cast<double>(x)) / 1e3);  // [m]
  }
  for (const Picture& picture : pictures_) {
    json["pictures"].push_back(
        {{"t_ns", to_ns(picture.t)}, {"events", base64(picture.events)}, {"frame", base64(picture.frame)}});
    for (const auto& [camera, jpeg] : picture.others) json["pictures"].back()["others"][camera] = base64(jpeg);
  }
  return json;
}

Trajectory Snapshots::part_of_run(const Trajectory& truth) const {
  constexpr Duration kMargin = std::chrono::seconds(1);  // clocks of sensors differ by less
  if (changes_.all().empty()) return {};
  auto first = std::ranges::lower_bound(truth, changes_.all().front().t - kMargin, {}, &StampedPose::t);
  auto past = std::ranges::upper_bound(truth, last_ + kMargin, {}, &StampedPose::t);
  if (first != truth.begin()) --first;  // of a sparse one, what the first pose lies between
  if (past != truth.end()) ++past;
  return {first, past};
}

RunOutput snapshots_output() {
  return always<SnapshotFiles>({"album.json", "groundtruth.tum", "calibration_found.yaml"});
}

}  // namespace edged
