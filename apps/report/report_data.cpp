// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/report_data.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "common/cli.hpp"
#include "common/config_source.hpp"
#include "common/json_text.hpp"
#include "common/log.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/core/check.hpp"
#include "edged/core/path_length.hpp"
#include "edged/core/whole_file.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "report/point_cloud.hpp"
#include "report/report_rows.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 3000, kMostRowsInAll = 6000, kMostPicturesInAll = 60, kMostMapKeyframes = 2000;
constexpr std::size_t kMostDensePoints = 1'000'000, kMostVoxels = 250'000;  // in all
constexpr std::uintmax_t kMostTrajectoryBytes = 2'000'000;                  // in all
constexpr std::size_t kLogLines = 300;

/// The files of a run, all but its poses as they are.
struct LoadedRun {
  fs::path path;
  StatesTable states;  ///< of a trajectory file: Good rows without columns
  Json metrics, album, timing;
  std::optional<Calibration> given, found;
  std::optional<GroundTruth> truth;
  AlignedPath poses;
};

/// Null if it is missing, or truncated by a kill.
Json read_json(const fs::path& file) {
  std::ifstream in(file);
  Json json = in ? Json::parse(in, nullptr, false) : Json();
  return json.is_discarded() ? Json() : json;
}

std::optional<Calibration> read_calibration(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  HeldWarnings said_by_the_run;
  std::optional<Calibration> calibration = load_calibration(file);
  said_by_the_run.take();
  return calibration;
}

/// The ground truth of the run.
std::optional<GroundTruth> own_truth(const LoadedRun& run) {
  const fs::path file = run.path / "groundtruth.tum";
  if (!fs::exists(file) || run.album.is_null()) return std::nullopt;
  return GroundTruth{read_tum(file), run.album.value("truth_frame", "body")};
}

std::string output_frame(const LoadedRun& run) {
  return run.metrics.is_null() ? "body" : run.metrics.value("output_frame", "body");
}

/// The rig of the run, with the calibration that it estimated, if it ended.
Rig rig_of(const LoadedRun& run) { return run.found ? rig_for_poses(run.given->rig, run.found->rig) : run.given->rig; }

/// A path in the world that is shown: with the alignment of the causal poses.
Trajectory as_shown(const LoadedRun& run, Trajectory path, const std::string& frame) {
  const Rig rig = rig_of(run);
  const OutputFrame written(rig, frame), shown(rig, run.poses.frame);
  for (StampedPose& pose : path) {
    pose = shown(written.to_body(pose));
    pose.T = run.poses.alignment * pose.T;
  }
  return path;
}

/// The final trajectory.
Trajectory final_path(const LoadedRun& run) {
  const fs::path file = run.path / "trajectory_final.tum";
  if (!run.given || !fs::exists(file)) return {};
  HeldWarnings said_by_the_run;
  Trajectory path = read_tum(file);
  said_by_the_run.take();
  return as_shown(run, std::move(path), output_frame(run));
}

/// The poses of the map's keyframes; found: the number of images with matches of each.
Json map_keyframes_json(const LoadedRun& run, Timestamp origin) {
  Json json = Json::object();
  if (!run.given) return json;
  const std::vector<MappedKeyframe> keyframes = read_keyframes(run.path);
  Trajectory path;
  for (const MappedKeyframe& keyframe : keyframes) path.push_back({keyframe.t, keyframe.T_W_B});
  path = as_shown(run, std::move(path), "body");
  for (std::size_t i = 0, stride = path.size() / kMostMapKeyframes + 1; i < path.size(); i += stride) {
    json["t"].push_back(rounded(to_seconds(path[i].t - origin), 3));
    for (int k = 0; k < 3; ++k) json[std::string(1, "xyz"[k])].push_back(rounded(path[i].T.translation()[k], 4));
    json["found"].push_back(keyframes[i].times_found);
  }
  return json;
}

/// The causal poses. What came before the body was found in the map of --map is in a frame of its own, and counts for
/// no error.
CausalPoses poses_in_map(const LoadedRun& run, const OutputFrame& frame) {
  HeldWarnings said_by_the_run;
  CausalPoses poses = causal_poses(run.path, run.states, output_frame(run), frame);
  said_by_the_run.take();
  if (!run.album.is_null() && !run.album.value("in_map_since_ns", Json()).is_null())
    poses.begin_at(timestamp_from_ns(run.album["in_map_since_ns"].get<std::int64_t>()));
  return poses;
}

LoadedRun load_folder(const fs::path& folder, const ReportOptions& options) {
  if (!fs::exists(folder / "states.csv") || !fs::exists(folder / "calibration.yaml")) {
    throw InputError::format("{}: is not a run folder (states.csv, calibration.yaml); give a folder of `edged run`",
                             folder.string());
  }
  LoadedRun run{folder,
                read_states(folder),
                read_json(folder / "metrics.json"),
                read_json(folder / "album.json"),
                read_json(folder / "timing.json"),
                read_calibration(folder / "calibration.yaml"),
                read_calibration(folder / "calibration_found.yaml"),
                std::nullopt,
                {}};
  read_pace(folder, run.states);
  run.truth = own_truth(run);
  if (!options.truth.empty()) {
    if (run.metrics.is_null()) {
      throw InputError::format(
          "{}: ended before it wrote metrics.json, which states whose poses these are; run it again, or leave --truth "
          "out",
          folder.string());
    }
    run.truth = GroundTruth{read_trajectory(options.truth), output_frame(run)};
  }
  const OutputFrame frame(rig_of(run), run.truth ? run.truth->frame : output_frame(run));
  run.poses =
      align_with_truth(poses_in_map(run, frame), covariance_samples_of(run.states), frame, run.truth, options.how);
  return run;
}

/// Whether the comments at its beginning say so.
bool written_by_edged(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line) && line.starts_with('#'))
    if (line.starts_with("# edged ")) return true;
  return false;
}

/// Poses without a run folder, for the sensor of the run's ground truth. With that run's calibration.
LoadedRun load_file(const fs::path& file, const LoadedRun* beside, const ReportOptions& options) {
  LoadedRun run{file, {}, {}, {}, {}, std::nullopt, std::nullopt, std::nullopt, {}};
  const OutputFrame frame(beside ? rig_of(*beside) : Rig{}, beside ? beside->poses.frame : "body");
  CausalPoses poses;
  for (const StampedPose& pose : poses.shown = read_trajectory(file)) {
    poses.body.push_back(frame.to_body(pose));
    poses.rows.push_back(poses.rows.size());
    run.states.t.push_back(poses.body.back().t);
    run.states.status.push_back(TrackingStatus::Good);
  }
  if (beside) run.truth = beside->truth;
  if (!options.truth.empty()) run.truth = GroundTruth{read_trajectory(options.truth), frame.name()};
  run.poses = align_with_truth(poses, {}, frame, run.truth, options.how);
  return run;
}

/// Folders first, as files refer to them; otherwise in the given order.
std::vector<LoadedRun> load_runs(std::vector<fs::path> paths, const ReportOptions& options) {
  std::vector<LoadedRun> runs;
  for (const fs::path& path : paths) {
    if (!fs::exists(path)) {
      throw InputError::format("{}: not found; give a folder of `edged run`", path.string());
    }
  }
  std::stable_partition(paths.begin(), paths.end(), [](const fs::path& path) { return fs::is_directory(path); });
  for (const fs::path& path : paths) {
    const auto beside = std::ranges::find_if(runs, [](const LoadedRun& run) { return run.given && run.truth; });
    const LoadedRun* first = runs.empty() || !runs.front().given ? nullptr : &runs.front();
    runs.push_back(fs::is_directory(path) ? load_folder(path, options)
                                          : load_file(path, beside == runs.end() ? first : &*beside, options));
  }
  return runs;
}

Json changed_options(const fs::path& file) {
  Json changed = Json::array();
  RunConfig config;
  ConfigFields fields = ConfigFields::of(config);
  if (!fs::exists(file)) return changed;
  try {
    fields.load(file);
  } catch (const InputError& e) {
    return {{{"key", "config_resolved.yaml"},
             {"value", "not readable by this version"},
             {"default", ""},
             {"effect", e.what()}}};
  }
  for (const ConfigField& field : fields.all()) {
    if (field.get() == field.default_value) continue;
    changed.push_back({{"key", field.key},
                       {"value", field.get()},
                       {"default", field.default_value},
                       {"unit", field.unit},
                       {"effect", field.effect}});
  }
  return changed;
}

Json camera_json(const RigCamera& camera) {
  Json T = Json::array();
  const Eigen::Matrix4d matrix = camera.T_B_C.matrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) T.push_back(matrix(row, column));
  }
  return {{"T_B_C", T}, {"time_offset_ms", 1e3 * to_seconds(camera.time_offset)}};
}

Json calibration_json(const LoadedRun& run) {
  Json cameras = Json::array();
  if (!run.given) return cameras;
  for (const RigCamera& camera : run.given->rig.cameras) {
    Json json = {{"camera", camera.name}, {"before", camera_json(camera)}, {"after", nullptr}};
    if (run.found) json["after"] = camera_json(run.found->rig.camera(camera.name));
    cameras.push_back(json);
  }
  return cameras;
}

Json last_lines(const fs::path& file) {
  std::deque<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
    if (lines.size() > kLogLines) lines.pop_front();
  }
  return Json(std::vector<std::string>(lines.begin(), lines.end()));
}

/// Evenly chosen, their stamps as seconds.
Json pictures_json(const Json& album, Timestamp origin, std::size_t most) {
  Json out = Json::array();
  if (album.is_null() || most == 0) return out;
  const Json& pictures = album.at("pictures");
  const std::size_t stride = (pictures.size() + most - 1) / most;
  for (std::size_t i = 0; i < pictures.size(); i += stride) {
    const Timestamp t = timestamp_from_ns(pictures[i].at("t_ns").get<std::int64_t>());
    out.push_back(
        {{"t", to_seconds(t - origin)}, {"events", pictures[i].at("events")}, {"frame", pictures[i].at("frame")}});
    if (const auto others = pictures[i].find("others"); others != pictures[i].end())
      for (const auto& [camera, jpeg] : others->items()) out.back()["camera " + camera] = jpeg;
  }
  return out;
}

/// dense.ply or voxels.ply of the run, in the world that is shown; null where there are no points. axes: of voxels, the
/// directions of their edges.
Json cloud_json(const LoadedRun& run, const char* file, std::size_t most) {
  PointCloud cloud = run.given ? read_cloud(run.path / file, most) : PointCloud{};
  if (cloud.points.empty()) return nullptr;
  const Similarity& alignment = run.poses.alignment;
  for (Eigen::Vector3f& p : cloud.points) p = (alignment * p.cast<double>()).cast<float>();
  Json json = packed_json(cloud.points, cloud.grey);
  json["all"] = cloud.all;
  if (cloud.size_m == 0.0F) return json;
  json["edge_m"] = alignment.scale * static_cast<double>(cloud.size_m);
  const Eigen::Matrix3d axes = alignment.T.R();
  json["axes"] = std::vector<double>(axes.data(), axes.data() + axes.size());
  return json;
}

/// The trajectories of the run as its files are, to be saved from the page; null for one that is too large.
Json trajectories_json(const LoadedRun& run, std::uintmax_t most) {
  Json texts = Json::object();
  for (const char* name : {"trajectory.tum", "trajectory_final.tum"}) {
    const fs::path file = run.path / name;
    if (!run.given || !fs::exists(file)) continue;
    const std::uintmax_t size = fs::file_size(file);
    texts[name] = nullptr;
    if (size > most) continue;
    most -= size;
    if (const auto text = read_file(file)) texts[name] = *text;
  }
  return texts;
}

/// How much of one run is shown.
struct Shares {
  std::size_t rows, pictures, dense_points, voxels;
  std::uintmax_t trajectory_bytes;
};

Json run_json(const LoadedRun& run, Timestamp origin, const Shares& most) {
  const fs::path name = run.path.has_filename() ? run.path.filename() : run.path.parent_path().filename();
  Json json = {{"name", name.string()},
               {"folder", run.path.string()},
               {"is_file", !run.given.has_value()},
               {"by_edged", run.given.has_value() || written_by_edged(run.path)},
               {"metrics", run.metrics},
               {"frame", run.poses.frame},
               {"origin_ns", to_ns(origin)},
               {"evaluation", nullptr},
               {"not_compared", run.poses.not_compared},
               {"path_m", path_length(run.poses.shown, &StampedPose::T)}};
  if (run.poses.evaluation) json["evaluation"] = to_json(*run.poses.evaluation);
  json["rows"] = rows_json(run.states, run.poses, origin, most.rows);
  json["pose_errors"] = pose_errors_json(run.poses.pose_errors, origin, most.rows);
  json["external"] = run.given ? external_json(run.path, origin, most.rows) : Json::object();
  json["truth"] = path_json(run.poses.true_path, most.rows);
  json["final"] = path_json(final_path(run), most.rows);
  json["trajectories"] = trajectories_json(run, most.trajectory_bytes);
  json["map_keyframes"] = map_keyframes_json(run, origin);
  json["map"] = map_json(run.album, run.poses.alignment);
  json["dense"] = cloud_json(run, "dense.ply", most.dense_points);
  json["voxels"] = cloud_json(run, "voxels.ply", most.voxels);
  json["changes"] = changes_json(run.states, run.album, origin);
  json["options"] = changed_options(run.path / "config_resolved.yaml");
  json["calibration"] = calibration_json(run);
  json["stages"] = run.timing.is_null() ? Json::array() : run.timing.at("stages");
  json["log"] = last_lines(run.path / "run.log");
  json["pictures"] = pictures_json(run.album, origin, most.pictures);
  return json;
}

/// Runs that overlap in time with the first one share its time origin, others have their own.
Timestamp origin_of(const LoadedRun& run, const LoadedRun& first) {
  if (run.states.t.empty()) return Timestamp{};
  const auto& [a, b] = std::tie(run.states.t, first.states.t);
  const bool overlap = !b.empty() && a.front() <= b.back() && b.front() <= a.back();
  return overlap ? b.front() : a.front();
}

}  // namespace

Json report_data(const std::vector<fs::path>& paths, const ReportOptions& options) try {
  const std::vector<LoadedRun> runs = load_runs(paths, options);
  Json json = {{"version", kVersion}, {"runs", Json::array()}};
  const std::size_t n = std::max<std::size_t>(1, runs.size());
  const Shares most{std::min(kMostRows, kMostRowsInAll / n), kMostPicturesInAll / n, kMostDensePoints / n,
                    kMostVoxels / n, kMostTrajectoryBytes / n};
  for (const LoadedRun& run : runs) json["runs"].push_back(run_json(run, origin_of(run, runs.front()), most));
  return json;
} catch (const Json::exception& e) {
  throw InputError::format("{}: a json file there is damaged ({}); run it again",
                           paths.front().string() + (paths.size() > 1 ? " or beside" : ""), e.what());
}

}  // namespace edged
