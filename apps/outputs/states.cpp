// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/states.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <optional>

#include "common/files.hpp"
#include "common/step_numbers.hpp"
#include "edged/core/check.hpp"
#include "report/states_table.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

constexpr const char* kStatesHeader =
    "t_ns,status,px_m,py_m,pz_m,qx,qy,qz,qw,vx_mps,vy_mps,vz_mps,bgx_radps,bgy_radps,bgz_radps,bax_mps2,bay_mps2,"
    "baz_mps2,keyframe,relocalized,event_tracks,frame_tracks,landmarks,event_track_survival_rate,frame_track_survival_"
    "rate,map_matches,map_"
    "reach_s,event_rate_hz,scene_depth_m,"
    "depth_scale,depth_scale_sigma_ln,p_xx_m2,p_xy_m2,p_xz_m2,p_yy_m2,p_yz_m2,p_zz_m2,r_xx_rad2,r_xy_rad2,r_xz_rad2,"
    "r_yy_rad2,r_yz_rad2,r_zz_rad2,v_xx_m2ps2,v_xy_m2ps2,v_xz_m2ps2,v_yy_m2ps2,v_yz_m2ps2,v_zz_m2ps2\n";

void append(std::string& line, const Eigen::Vector3d& v) { line += fmt::format(",{},{},{}", v.x(), v.y(), v.z()); }

void append(std::string& line, const Eigen::Quaterniond& q) {
  line += fmt::format(",{},{},{},{}", q.x(), q.y(), q.z(), q.w());
}

/// The upper triangle, row by row.
void append(std::string& line, const Eigen::Matrix3d& P) {
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) line += fmt::format(",{}", P(row, column));
  }
}

std::string state_line(const Step& step) {
  std::string line = fmt::format("{},{}", to_ns(step.t), to_string(step.status));
  if (step.status == TrackingStatus::Initializing) {
    line += ",,,";
    if (step.attitude) {
      append(line, step.attitude->R_W_B);
    } else {
      line += ",,,,";
    }
    line += std::string(9, ',');
  } else {
    const NavState& state = step.state;
    append(line, state.T_W_B.translation());
    append(line, state.T_W_B.rotation());
    append(line, state.v_W);
    append(line, state.bias_gyro);
    append(line, state.bias_accel);
  }
  const ModalityNumbers events = modality_numbers(step, Modality::Events),
                        frames = modality_numbers(step, Modality::Frames);
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
    append(line, step.covariance->velocity);
  } else if (step.attitude) {
    line += std::string(6, ',');
    append(line, step.attitude->covariance);
    line += std::string(6, ',');
  } else {
    line += std::string(18, ',');
  }
  return line + '\n';
}

constexpr const char* kKnownWhen = "causal: each estimated from the measurements up to its time";

class StatesFiles : public RunObserver {
 public:
  explicit StatesFiles(const RunContext& run) : run_(run) {}
  void on_begin() override {
    writer_.emplace(run_.folder, run_.frame, run_.heading(run_.frame, kKnownWhen));
    pace_.emplace(run_.folder);
  }
  void on_step(const Step& step) override {
    writer_->add(step);
    pace_->add(step.t, run_.pace);
  }
  /// Poses of a camera are written anew, by the calibration that the run found.
  void on_end(const RunEnd&) override {
    writer_.reset();
    if (run_.frame.name() == "body") return;
    const OutputFrame frame = run_.estimated_frame();
    const std::filesystem::path part = run_.folder / "trajectories.part";
    std::filesystem::create_directory(part);
    {
      TrajectoryFiles files(part, run_.heading(frame, kKnownWhen));
      for (const StampedPose& pose : body_poses(read_states(run_.folder))) files.add(frame(pose));
      files.flush();
    }
    for (const char* name : TrajectoryFiles::kNames) std::filesystem::rename(part / name, run_.folder / name);
    std::filesystem::remove(part);
  }

 private:
  const RunContext& run_;
  std::optional<RunWriter> writer_;
  std::optional<PaceWriter> pace_;
};

}  // namespace

TrajectoryFiles::TrajectoryFiles(const std::filesystem::path& folder, const std::vector<std::string>& comments)
    : tum_(folder / kNames[0], TrajectoryFormat::Tum, comments),
      euroc_(folder / kNames[1], TrajectoryFormat::EurocCsv, comments),
      kitti_(folder / kNames[2], TrajectoryFormat::Kitti, {}) {}

void TrajectoryFiles::add(const StampedPose& pose) {
  tum_.add(pose);
  euroc_.add(pose);
  kitti_.add(pose);
}

void TrajectoryFiles::flush() {
  tum_.flush();
  euroc_.flush();
  kitti_.flush();
}

RunWriter::RunWriter(const std::filesystem::path& folder, const OutputFrame& frame,
                     const std::vector<std::string>& comments)
    : frame_(frame),
      trajectory_(folder, comments),
      states_file_(folder / "states.csv"),
      states_(open_for_writing(states_file_)) {
  states_ << "# state of the body (IMU) in the world (z up), stamps on the IMU clock, whatever the trajectory's frame\n"
          << kStatesHeader;
  flush();  // a run without a packet leaves readable files, too
}

void RunWriter::add(const Step& step) {
  states_ << state_line(step);
  if (is_tracking(step.status)) {
    ++poses_;
    trajectory_.add(frame_({step.t, step.state.T_W_B}));
  }
  // Each line is flushed: a kill must not leave a partial line.
  flush();
}

void RunWriter::flush() {
  trajectory_.flush();
  if (!states_.flush()) throw InputError::format("{}: cannot be written; is the disk full?", states_file_.string());
}

PaceWriter::PaceWriter(const std::filesystem::path& folder) : out_(folder / "pace.csv") {
  out_ << "t_ns,processing_ms,latency_ms\n" << std::flush;
}

void PaceWriter::add(Timestamp t, const PacketPace& pace) {
  out_ << fmt::format("{},{:.3f},{}\n", to_ns(t), pace.processing_ms,
                      pace.latency_ms ? fmt::format("{:.3f}", *pace.latency_ms) : "")
       << std::flush;
}

RunOutput states_output() {
  return always<StatesFiles>({"trajectory.tum", "trajectory_euroc.csv", "trajectory.kitti", "states.csv", "pace.csv"});
}

}  // namespace edged
