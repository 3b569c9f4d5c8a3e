// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/mcap.hpp"

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <utility>

#include "common/cli.hpp"
#include "common/json_text.hpp"
#include "common/pictures.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/camera/undistort.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

// Rates and sizes keep a minute of two cameras of 346x260 at some 10 MB.
constexpr Duration kPicturePeriod = std::chrono::milliseconds(200), kPathPeriod = std::chrono::seconds(1),
                   kMapPeriodOfFile = std::chrono::seconds(5);
constexpr int kWidestOfFile_px = 640;
constexpr std::size_t kMostFinal = 3000;  // of the poses of a path
constexpr double kFrustum_m = 0.1;        // from a keyframe to the corners of its view

constexpr const char* kWorld = "world";
constexpr const char* kOdom = "odom";
constexpr const char* kBody = "body";
constexpr const char* kFrameTransforms = "foxglove.FrameTransforms";
constexpr const char* kPosesInFrame = "foxglove.PosesInFrame";
constexpr const char* kPointCloud = "foxglove.PointCloud";
constexpr const char* kSceneUpdate = "foxglove.SceneUpdate";

/// "/events/image" of the first camera of a kind, "/NAME/image" of the others.
std::string topic_of(const Rig& rig, const std::string& name, const char* what) {
  for (const Modality modality : {Modality::Events, Modality::Frames})
    if (const RigCamera* first = rig.find(modality); first && first->name == name)
      return fmt::format("/{}/{}", modality == Modality::Events ? "events" : "frames", what);
  return fmt::format("/{}/{}", name, what);
}

double picture_scale(int width) { return std::min(1.0, static_cast<double>(kWidestOfFile_px) / width); }

foxglove::Point point_of(const Eigen::Vector3d& p) {
  const Eigen::Vector3f f = p.cast<float>();
  return {f.x(), f.y(), f.z()};
}

template <typename T>
std::vector<T> even_sample(const std::vector<T>& values) {
  EvenSample<T> kept(kMostFinal);
  for (const T& value : values) kept.add(value);
  return kept.all();
}

/// One pyramid per keyframe: the camera and the corners of its image at some distance.
foxglove::Lines frusta(const std::vector<StampedPose>& bodies, const RigCamera& camera) {
  const CameraModel& m = camera.model;
  const double on_axis = axis_slope(m), fx = on_axis * m.fx(), fy = on_axis * m.fy();
  foxglove::Lines lines{"keyframes", {}, {}, {0.2, 0.6, 1.0, 0.8}};
  for (const StampedPose& body : bodies) {
    const auto apex = static_cast<unsigned>(lines.points.size());
    const SE3 T_W_C = body.T * camera.T_B_C;
    lines.points.push_back(point_of(T_W_C.translation()));
    for (const auto& [u, v] :
         {std::pair(0, 0), std::pair(m.width(), 0), std::pair(m.width(), m.height()), std::pair(0, m.height())})
      lines.points.push_back(point_of(
          T_W_C * Eigen::Vector3d(kFrustum_m * (u - m.cx()) / fx, kFrustum_m * (v - m.cy()) / fy, kFrustum_m)));
    for (unsigned k = 0; k < 4; ++k)
      for (const unsigned end : {apex, apex + 1 + k, apex + 1 + k, apex + 1 + (k + 1) % 4}) lines.pairs.push_back(end);
  }
  return lines;
}

std::vector<foxglove::Point> map_points(const std::vector<MappedKeyframe>& keyframes) {
  std::vector<foxglove::Point> points;
  for (const MappedKeyframe& keyframe : keyframes)
    for (const MappedKeyframe::Point& point : keyframe.points)
      if (point.p_W.allFinite()) points.push_back(point_of(point.p_W));
  return points;
}

std::vector<foxglove::Point> points_of(const Snapshots& snapshots) {
  std::vector<foxglove::Point> points;
  for (const auto& [id, point] : snapshots.points()) points.push_back(point);
  return points;
}

foxglove::Level level_of(TrackingStatus status) {
  return status == TrackingStatus::Lost       ? foxglove::Level::Error
         : status == TrackingStatus::Degraded ? foxglove::Level::Warning
                                              : foxglove::Level::Info;
}

/// A hash to compare the options of two runs (FNV-1a, 64 bit).
std::string hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

FileMetadata metadata_of(const RunContext& run) {
  const std::string options = options_text(run.config);
  return {{"version", kVersion},
          {"recording", run.info().name},
          {"format", run.info().format},
          {"mode", mode_name(run.mode)},
          {"options", options},
          {"options_hash", hash_of(options)},
          {"calibration", to_yaml(run.source.calibration)}};
}

struct McapOptions {
  bool wanted = false;
};

class McapFile : public RunObserver {
 public:
  explicit McapFile(RunContext& run) : run_(run), snapshots_(run.products.get<Snapshots>()) {}
  const char* stage() const override { return "mcap"; }
  void on_begin() override { file_.emplace(run_.folder / "results.mcap", run_.rig, metadata_of(run_)); }
  void on_step(const Step& step) override { file_->add(step, snapshots_); }
  void on_end(const RunEnd& end) override {
    file_->finish(end.final_trajectory, snapshots_, true_body(end), end.summary);
  }

 private:
  /// The truth over the time of the run, in the world of the estimate.
  Trajectory true_body(const RunEnd& end) const {
    Trajectory body;
    if (!end.summary.truth.evaluation) return body;
    const OutputFrame sensor(run_.estimated_rig(), end.truth->frame);
    const SE3 T_estimate_truth = end.summary.truth.evaluation->alignment.T.inverse();
    for (const StampedPose& pose : snapshots_.part_of_run(end.truth->trajectory))
      body.push_back(sensor.to_body({pose.t, T_estimate_truth * pose.T}));
    return body;
  }

  const RunContext& run_;
  const Snapshots& snapshots_;
  std::optional<ResultsMcap> file_;
};

}  // namespace

/// True also where the clock has been set back.
bool ResultsMcap::Pace::due(Timestamp t) {
  if (last_ && t >= *last_ && t < *last_ + period_) return false;
  last_ = t;
  return true;
}

ResultsMcap::ResultsMcap(const std::filesystem::path& file, Rig rig, const FileMetadata& metadata)
    : file_(file, ""), rig_(std::move(rig)), path_pace_(kPathPeriod), map_pace_(kMapPeriodOfFile) {
  for (RigCamera& camera : rig_.cameras)
    if (camera.modality == Modality::Events) camera.model = ideal_pinhole(camera.model);
  file_.write_metadata("edged", metadata);
}

void ResultsMcap::put(const std::string& topic, const char* type, Timestamp t, const foxglove::Json& message) {
  auto place = topics_.find(topic);
  if (place == topics_.end()) {
    const std::string schema = foxglove::schema_of(type);
    place = topics_.emplace(topic, file_.add_topic({topic, "json", type, "jsonschema", schema})).first;
  }
  file_.write(place->second, t, compact_json(message));
}

void ResultsMcap::add(const Step& step, const Snapshots& snapshots) {
  if (!first_) describe_cameras(step.t);
  last_ = step.t;
  put_status(step);
  put("/stats", "edged.Stats", step.t, foxglove::stats(step));
  if (is_tracking(step.status)) put_pose(step);
  put_pictures(step);
  if (!snapshots.points().empty() && map_pace_.due(step.t)) {
    put("/map", kPointCloud, step.t, foxglove::point_cloud(step.t, kWorld, points_of(snapshots)));
    put_keyframes(step.t);
  }
}

/// Causal poses; all in one message, as players that seek read only the last one of a topic.
void ResultsMcap::describe_cameras(Timestamp t) {
  first_ = t;
  std::vector<foxglove::Transform> transforms;
  for (const RigCamera& camera : rig_.cameras) {
    transforms.push_back({kBody, camera.name, camera.T_B_C});
    put(topic_of(rig_, camera.name, "calibration"), "foxglove.CameraCalibration", t,
        foxglove::camera_calibration(t, camera, picture_scale(camera.model.width())));
  }
  put("/tf_static", kFrameTransforms, t, foxglove::frame_transforms(t, transforms));
}

void ResultsMcap::put_pose(const Step& step) {
  const SE3& T_W_B = step.state.T_W_B;
  put("/tf", kFrameTransforms, step.t,
      foxglove::frame_transforms(step.t, {{kWorld, kOdom, step.T_M_O}, {kOdom, kBody, step.T_M_O.inverse() * T_W_B}}));
  put("/pose", "foxglove.PoseInFrame", step.t, foxglove::pose_in_frame(step.t, kWorld, T_W_B));
  path_.add({step.t, T_W_B});
  if (step.keyframe) keyframes_.add({step.t, T_W_B});
  if (path_pace_.due(step.t)) {
    put("/path", kPosesInFrame, step.t, foxglove::poses_in_frame(step.t, kWorld, path_.all()));
    std::vector<foxglove::Point> landmarks;
    for (const Landmark& landmark : step.landmarks)
      if (landmark.p_W.allFinite()) landmarks.push_back(point_of(landmark.p_W));
    put("/landmarks", kPointCloud, step.t, foxglove::point_cloud(step.t, kWorld, landmarks));
  }
}

void ResultsMcap::put_pictures(const Step& step) {
  for (const CameraStep& camera : step.cameras) {
    if (camera.image.empty() || !picture_paces_.try_emplace(camera.name, kPicturePeriod).first->second.due(step.t))
      continue;
    put(topic_of(rig_, camera.name, "image"), "foxglove.CompressedImage", step.t,
        foxglove::compressed_image(step.t, camera.name, track_picture(camera.image, camera.tracks, kWidestOfFile_px)));
  }
}

void ResultsMcap::put_keyframes(Timestamp t) {
  put("/keyframes", kSceneUpdate, t, foxglove::scene_update(t, kWorld, frusta(keyframes_.all(), rig_.cameras.front())));
}

void ResultsMcap::put_status(const Step& step) {
  const auto say = [&](foxglove::Level level, const std::string& text) {
    put("/log", "foxglove.Log", step.t, foxglove::log(step.t, level, text));
  };
  if (step.relocalized) say(foxglove::Level::Info, "relocalized in the map");
  if (std::exchange(status_, step.status) == step.status) return;
  const std::string reason = reason_of(step);
  say(level_of(step.status), to_string(step.status) + (reason.empty() ? "" : ": " + reason));
}

void ResultsMcap::finish(const FinalTrajectory& final_trajectory, const Snapshots& snapshots, const Trajectory& truth,
                         const RunSummary& summary) {
  if (first_) {
    put_keyframes(last_);
    put("/path", kPosesInFrame, last_, foxglove::poses_in_frame(last_, kWorld, path_.all()));
    put("/path_final", kPosesInFrame, last_,
        foxglove::poses_in_frame(last_, kWorld, even_sample(final_trajectory.poses)));
    const std::vector<foxglove::Point> points = map_points(final_trajectory.keyframes);
    put("/map", kPointCloud, last_,
        foxglove::point_cloud(last_, kWorld, points.empty() ? points_of(snapshots) : points));
    for (const Finding& finding : summary.verdict.findings)
      put("/log", "foxglove.Log", last_,
          foxglove::log(last_, foxglove::Level::Warning, finding.text + ": " + finding.remedy));
    put("/log", "foxglove.Log", last_, foxglove::log(last_, foxglove::Level::Info, "ended: " + summary.verdict.status));
  }
  if (!truth.empty()) {
    foxglove::Lines line{"ground truth", {}, {}, {0.6, 0.6, 0.6, 1.0}};
    for (const StampedPose& pose : even_sample(truth)) line.points.push_back(point_of(pose.T.translation()));
    // Known only now, but to be shown from the beginning.
    file_.close_chunk();
    put("/ground_truth", kSceneUpdate, *first_, foxglove::scene_update(*first_, kWorld, line));
  }
  file_.write_metadata("metrics", {{"metrics.json", json_text(to_json(summary))}});
  file_.finish();
}

RunOutput mcap_output() {
  return {{"results.mcap"},
          [](CLI::App& command, Board& options) {
            command.add_flag(
                "--mcap", options.get<McapOptions>().wanted,
                "Also write results.mcap: poses, path, map, images and numbers for Foxglove, Lichtblick and "
                "others (about 10 MB per minute)");
          },
          [](RunContext& run) -> std::unique_ptr<RunObserver> {
            if (!run.options.outputs.get<McapOptions>().wanted) return nullptr;
            return std::make_unique<McapFile>(run);
          }};
}

}  // namespace edged
