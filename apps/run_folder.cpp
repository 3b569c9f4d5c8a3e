// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_folder.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>

#include "claims.hpp"
#include "edged/core/check.hpp"
#include "edged/io/text.hpp"

namespace edged {
namespace {

// The first is written before anything else and marks a folder as a run's.
constexpr std::array kRunFiles = {"config_resolved.yaml", "calibration.yaml", "trajectory.tum",
                                  "trajectory_euroc.csv", "states.csv",       "metrics.json",
                                  "timing.json",          "overview.png",     "run.log"};

constexpr const char* kStatesHeader =
    "t_ns,status,px_m,py_m,pz_m,qx,qy,qz,qw,vx_mps,vy_mps,vz_mps,bgx_radps,bgy_radps,bgz_radps,bax_mps2,bay_mps2,"
    "baz_mps2,keyframe,event_tracks,frame_tracks,landmarks,event_rate_hz,scene_depth_m,"
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
  line += fmt::format(",{},{},{},{},{},{}", step.keyframe ? 1 : 0, step.event_tracks.size(), step.frame_tracks.size(),
                      step.landmarks.size(), step.event_rate_hz, step.scene_depth);
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

std::optional<TrackingStatus> parse_status(std::string_view text) {
  for (const auto status :
       {TrackingStatus::Initializing, TrackingStatus::Good, TrackingStatus::Degraded, TrackingStatus::Lost}) {
    if (text == to_string(status)) return status;
  }
  return std::nullopt;
}

/// The upper triangle, row by row.
Eigen::Matrix3d symmetric(const double* v) {
  Eigen::Matrix3d P;
  P << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
  return P;
}

}  // namespace

void make_run_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw InputError::format("{}: is a file, not a folder; give another --out", folder.string());
  }
  if (fs::is_directory(folder) && !fs::is_empty(folder) && !fs::exists(folder / kRunFiles[0])) {
    throw InputError::format("{}: holds files, but no earlier run; give another --out", folder.string());
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError::format("{}: cannot be made: {}", folder.string(), error.message());
  for (const char* file : kRunFiles) {
    fs::remove(folder / file);
    fs::remove(part_of(folder / file));
  }
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = part_of(file);
  std::ofstream out = open_for_writing(part);
  out << text;
  if (!out.flush()) throw InputError::format("{}: cannot be written; is the disk full?", file.string());
  std::filesystem::rename(part, file);
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
    }
  }
  return nlohmann::ordered_json{{"stages", stages}}.dump(2) + "\n";
}

RunWriter::RunWriter(const std::filesystem::path& folder, const OutputFrame& frame,
                     const std::vector<std::string>& comments)
    : frame_(frame),
      tum_(folder / "trajectory.tum", TrajectoryFormat::Tum, comments),
      euroc_(folder / "trajectory_euroc.csv", TrajectoryFormat::EurocCsv, comments),
      states_(open_for_writing(folder / "states.csv")) {
  states_ << "# state of the body (IMU) in the world (z up), stamps on the IMU clock, whatever the trajectory's frame\n"
          << kStatesHeader;
}

void RunWriter::add(const Step& step) {
  states_ << state_line(step);
  if (is_tracking(step.status)) {
    ++poses_;
    const StampedPose pose = frame_({step.t, step.state.T_W_B});
    tum_.add(pose);
    euroc_.add(pose);
  }
  // Each line goes out by itself: a buffer that is left to fill up ends within one, and there a kill would leave it.
  tum_.flush();
  euroc_.flush();
  states_.flush();
}

WrittenStates read_states(const std::filesystem::path& folder) {
  constexpr int kFieldsBetween = 17;  // motion, biases, counts, depth
  WrittenStates out;
  Claims claims;
  std::ifstream states(folder / "states.csv");
  for (std::string line; std::getline(states, line);) {
    FieldReader fields(line);
    const auto t = parse_nanoseconds(fields.next());
    const auto status = parse_status(fields.next());
    std::array<double, 7> v;
    if (!t || !status || !read_numbers(fields, v)) continue;
    Step step;
    step.t = *t;
    step.status = *status;
    step.state.T_W_B = SE3(Eigen::Quaterniond(v[6], v[3], v[4], v[5]), Eigen::Vector3d(v[0], v[1], v[2]));
    for (int i = 0; i < kFieldsBetween; ++i) fields.next();
    std::array<double, 12> P;
    if (read_numbers(fields, P)) step.covariance = {symmetric(P.data()), symmetric(P.data() + 6)};
    if (is_tracking(*status)) out.body.push_back({*t, step.state.T_W_B});
    claims.add(step);
  }
  out.claims = claims.all();
  return out;
}

}  // namespace edged
