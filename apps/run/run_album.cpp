// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_album.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/files.hpp"
#include "common/pictures.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "run/run_observer.hpp"
#include "run/verdict.hpp"

namespace edged {
namespace {

constexpr int kWidest_px = 320;

/// The observer that keeps the album.
class AlbumFiles : public RunObserver {
 public:
  explicit AlbumFiles(RunContext& run) : run_(run) {}
  void on_step(const Step& step) override { run_.album.add(step); }
  void on_end(const RunEnd& end) override {
    run_.album.write(run_.folder, run_.source.calibration, run_.odometry.rig(), end.truth, end.in_map_since);
  }

 private:
  RunContext& run_;
};

}  // namespace

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kLetters[group >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

void RunAlbum::add(const Step& step) {
  last_ = step.t;
  changes_.add(step);
  take_picture(step);
  if (step.keyframe) points_.add(step.landmarks);
}

void RunAlbum::take_picture(const Step& step) {
  constexpr Duration kPatience = std::chrono::milliseconds(200);  // for a step with images of both cameras
  const auto seen_by = [&step](Modality modality) {               // the first camera of the kind
    const CameraStep* camera = step.find(modality);
    return camera && !camera->image.empty() ? camera : nullptr;
  };
  const CameraStep *events = seen_by(Modality::Events), *frame = seen_by(Modality::Frames);
  events_come_ |= events != nullptr;
  frames_come_ |= frame != nullptr;
  if (!events && !frame) return;
  if (!due_) due_ = step.t;
  if (step.t < *due_) return;
  if ((events_come_ && !events) || (frames_come_ && !frame)) {
    if (step.t < *due_ + kPatience) return;
  }
  const auto picture = [](const CameraStep* camera) {
    return camera ? track_picture(camera->image, camera->tracks, kWidest_px) : std::vector<unsigned char>{};
  };
  pictures_.push_back({step.t, picture(events), picture(frame)});
  for (const CameraStep& camera : step.cameras)
    if (&camera != step.find(camera.modality) && !camera.image.empty())
      pictures_.back().others[camera.name] = picture(&camera);
  if (pictures_.size() > kMostPictures) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pictures_.size(); i += 2) std::swap(pictures_[kept++], pictures_[i]);
    pictures_.resize(kept);
    spacing_ *= 2;
  }
  due_ = pictures_.back().t + spacing_;
}

nlohmann::ordered_json RunAlbum::to_json(const std::string& truth_frame, std::optional<Timestamp> in_map_since) const {
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

void RunAlbum::write(const std::filesystem::path& folder, const Calibration& given, const Rig& found,
                     const std::optional<GroundTruth>& truth, std::optional<Timestamp> in_map_since) const {
  constexpr Duration kMargin = std::chrono::seconds(1);  // clocks of sensors differ by less
  if (truth && !changes_.all().empty()) {
    const Trajectory& poses = truth->trajectory;
    auto first = std::ranges::lower_bound(poses, changes_.all().front().t - kMargin, {}, &StampedPose::t);
    auto past = std::ranges::upper_bound(poses, last_ + kMargin, {}, &StampedPose::t);
    if (first != poses.begin()) --first;  // of a sparse one, what the first pose lies between
    if (past != poses.end()) ++past;
    write_tum(folder / "groundtruth.tum", Trajectory(first, past),
              {"ground truth while the run lasted: " + OutputFrame(given.rig, truth->frame).describe()});
  }
  write_file(folder / "calibration_found.yaml", to_yaml(with_found(given, found)));
  write_file(folder / "album.json", to_json(truth ? truth->frame : "", in_map_since).dump() + "\n");
}

std::unique_ptr<RunObserver> observe_album(RunContext& run) { return std::make_unique<AlbumFiles>(run); }

}  // namespace edged
