// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_folder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <system_error>

#include "edged/core/check.hpp"
#include "kind_numbers.hpp"

namespace edged {
namespace {

// The first is written before anything else and marks a folder as a run's.
constexpr std::array kRunFiles = {"config_resolved.yaml",
                                  "calibration.yaml",
                                  "trajectory.tum",
                                  "trajectory_euroc.csv",
                                  "trajectory.kitti",
                                  "states.csv",
                                  "metrics.json",
                                  "timing.json",
                                  "overview.png",
                                  "run.log",
                                  "album.json",
                                  "groundtruth.tum",
                                  "calibration_found.yaml",
                                  "report.html",
                                  "trajectory_final.tum",
                                  "keyframes.csv",
                                  "map.ply",
                                  "pace.csv",
                                  "results.mcap"};

constexpr const char* kStatesHeader =
    "t_ns,status,px_m,py_m,pz_m,qx,qy,qz,qw,vx_mps,vy_mps,vz_mps,bgx_radps,bgy_radps,bgz_radps,bax_mps2,bay_mps2,"
    "baz_mps2,keyframe,relocalized,event_tracks,frame_tracks,landmarks,event_track_survival_rate,frame_track_survival_"
    "rate,map_matches,map_"
    "reach_s,event_rate_hz,scene_depth_m,"
    "depth_scale,depth_scale_sigma_ln,p_xx_m2,p_xy_m2,p_xz_m2,p_yy_m2,p_yz_m2,p_zz_m2,r_xx_rad2,r_xy_rad2,r_xz_rad2,"
    "r_yy_rad2,r_yz_rad2,r_zz_rad2\n";

/// Where a file is until it is complete.
std::filesystem::path part_of(std::filesystem::path file) { return file += ".part"; }

std::ofstream open_for_writing(const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw InputError::format("{}: cannot be written; check the folder given to --out", file.string());
  return out;
}

void append(std::string& line, const Eigen::Vector3d& v) { line += fmt::format(",{},{},{}", v.x(), v.y(), v.z()); }

/// The upper triangle, row by row.
void append(std::string& line, const Eigen::Matrix3d& P) {
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) line += fmt::format(",{}", P(row, column));
  }
}

std::string state_line(const Step& step) {
  std::string line = fmt::format("{},{}", to_ns(step.t), to_string(step.status));
  if (step.status == TrackingStatus::Initializing) {
    line += std::string(16, ',');
  } else {
    const NavState& state = step.state;
    const Eigen::Quaterniond& q = state.T_W_B.rotation();
    append(line, state.T_W_B.translation());
    line += fmt::format(",{},{},{},{}", q.x(), q.y(), q.z(), q.w());
    append(line, state.v_W);
    append(line, state.bias_gyro);
    append(line, state.bias_accel);
  }
  const KindNumbers events = numbers_of(step, Modality::Events), frames = numbers_of(step, Modality::Frames);
  line += fmt::format(",{},{},{},{},{}", step.keyframe ? 1 : 0, step.relocalized ? 1 : 0, events.tracks, frames.tracks,
                      step.landmarks.size());
  for (const std::optional<double>& number : {events.survival_rate, frames.survival_rate})
    line += number ? fmt::format(",{}", *number) : ",";
  const std::optional<double> reach_s = map_reach_s(step);
  line += reach_s ? fmt::format(",{},{}", step.map_matches.size(), *reach_s) : ",,";
  line += fmt::format(",{},{}", events.event_rate_hz, step.scene_depth);
  const auto& ln_s = step.ln_depth_scale;
  line += ln_s ? fmt::format(",{},{}", std::exp(ln_s->value), ln_s->sigma) : ",,";
  if (step.covariance) {
    append(line, step.covariance->position);
    append(line, step.covariance->rotation);
  } else {
    line += std::string(12, ',');
  }
  return line + '\n';
}

[[noreturn]] void refuse_folder(const std::filesystem::path& folder, const std::error_code& error) {
  throw InputError::format("{}: cannot be used as a run folder: {}; give another --out", folder.string(),
                           error.message());
}

/// Whether it is not there yet, empty, or an earlier run's. Throws InputError where that cannot be told.
bool may_hold_a_run(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::status_known(status)) refuse_folder(folder, error);
  if (!fs::exists(status)) return true;
  if (!fs::is_directory(status))
    throw InputError::format("{}: is a file, not a folder; give another --out", folder.string());
  const bool empty = fs::is_empty(folder, error);
  if (error) refuse_folder(folder, error);
  return empty || fs::exists(folder / kRunFiles[0]);
}

/// All but its mark.
void empty_of_run(const std::filesystem::path& folder) {
  for (const char* name : kRunFiles) {
    if (name == kRunFiles[0]) continue;
    for (const std::filesystem::path& file : {folder / name, part_of(folder / name)}) {
      std::error_code error;
      std::filesystem::remove(file, error);
      if (error) throw InputError::format("{}: cannot be replaced: {}", file.string(), error.message());
    }
  }
}

/// Makes the folder and its mark. False: an earlier run's mark is there.
bool claim(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) refuse_folder(folder, error);
  std::FILE* mark = std::fopen((folder / kRunFiles[0]).c_str(), "wx");  // one of several that try at once succeeds
  if (mark != nullptr) return std::fclose(mark), true;
  if (errno != EEXIST) refuse_folder(folder, {errno, std::generic_category()});
  return false;
}

}  // namespace

std::filesystem::path beside(const std::filesystem::path& folder, const std::string& suffix) {
  std::filesystem::path plain = folder.lexically_normal();
  if (!plain.has_filename()) plain = plain.parent_path();
  if (plain.empty() || plain.filename() == "." || plain.filename() == "..")
    plain = std::filesystem::weakly_canonical(folder);
  return plain += suffix;
}

std::filesystem::path make_run_folder(const std::filesystem::path& wanted, EarlierRun earlier) {
  if (!may_hold_a_run(wanted))
    throw InputError::format("{}: holds files, but no earlier run; give another --out", wanted.string());
  std::filesystem::path folder = wanted;
  if (earlier == EarlierRun::Replace) {
    empty_of_run(folder);
    claim(folder);
    return folder;
  }
  for (int number = 2; !may_hold_a_run(folder) || !claim(folder); ++number)
    folder = beside(wanted, fmt::format("-{}", number));
  return folder;
}

void give_back_run_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(folder / kRunFiles[0], ignored);
  std::filesystem::remove(folder, ignored);  // fails where it is not empty
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = part_of(file);
  std::ofstream out = open_for_writing(part);
  out << text;
  if (!out.flush()) throw InputError::format("{}: cannot be written; is the disk full?", file.string());
  std::filesystem::rename(part, file);
}

std::optional<double> map_reach_s(const Step& step) {
  const auto oldest = std::ranges::min_element(step.map_matches, {}, &MapMatch::keyframe);
  return oldest == step.map_matches.end() ? std::nullopt : std::optional(to_seconds(step.t - oldest->keyframe));
}

std::string timing_json(const StageTimings& pipeline, const StageTimings& program) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  for (const StageTimings* timings : {&program, &pipeline}) {
    for (const auto& [name, timing] : timings->all()) {
      stages.push_back({{"stage", name},
                        {"count", timing.count()},
                        {"mean_ms", 1e3 * timing.mean_s()},
                        {"p50_ms", 1e3 * timing.quantile_s(0.50)},
                        {"p95_ms", 1e3 * timing.quantile_s(0.95)},
                        {"p99_ms", 1e3 * timing.quantile_s(0.99)},
                        {"max_ms", 1e3 * timing.max_s()},
                        {"total_s", timing.total_s()}});
      if (timing.cpu_s()) stages.back()["cpu_s"] = *timing.cpu_s();
    }
  }
  return nlohmann::ordered_json{{"stages", stages}}.dump(2) + "\n";
}

RunWriter::RunWriter(const std::filesystem::path& folder, const OutputFrame& frame,
                     const std::vector<std::string>& comments)
    : frame_(frame),
      tum_(folder / "trajectory.tum", TrajectoryFormat::Tum, comments),
      euroc_(folder / "trajectory_euroc.csv", TrajectoryFormat::EurocCsv, comments),
      kitti_(folder / "trajectory.kitti", TrajectoryFormat::Kitti, {}),
      states_file_(folder / "states.csv"),
      states_(open_for_writing(states_file_)) {
  states_ << "# state of the body (IMU) in the world (z up), stamps on the IMU clock, whatever the trajectory's frame\n"
          << kStatesHeader;
  flush();  // a run without a packet leaves files that can be read, too
}

void RunWriter::add(const Step& step) {
  states_ << state_line(step);
  if (is_tracking(step.status)) {
    ++poses_;
    const StampedPose pose = frame_({step.t, step.state.T_W_B});
    tum_.add(pose);
    euroc_.add(pose);
    kitti_.add(pose);
  }
  // Each line goes out by itself: a buffer that is left to fill up ends within one, and there a kill would leave it.
  flush();
}

void RunWriter::flush() {
  tum_.flush();
  euroc_.flush();
  kitti_.flush();
  if (!states_.flush()) throw InputError::format("{}: cannot be written; is the disk full?", states_file_.string());
}

}  // namespace edged
