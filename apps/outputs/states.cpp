// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/states.hpp"

#include <optional>

#include "common/files.hpp"
#include "report/states_table.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

constexpr const char* kKnownWhen = "causal: each estimated from the measurements up to its time";

class StatesFiles : public RunObserver {
 public:
  explicit StatesFiles(const RunContext& run) : run_(run) {}
  void on_begin() override {
    writer_.emplace(run_.folder, run_.frame, run_.heading(run_.frame, kKnownWhen));
    pace_.emplace(run_.folder / "pace.csv", pace_heading());
  }
  void on_step(const Step& step) override {
    writer_->add(step);
    pace_->add(pace_line(step.t, run_.pace));
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
  std::optional<TableFile> pace_;
};

}  // namespace

TrajectoryFiles::TrajectoryFiles(const std::filesystem::path& folder, const std::vector<std::string>& comments) {
  constexpr std::array kFormats{TrajectoryFormat::Tum, TrajectoryFormat::EurocCsv, TrajectoryFormat::Kitti};
  for (std::size_t i = 0; i < kNames.size(); ++i) files_.emplace_back(folder / kNames[i], kFormats[i], comments);
}

void TrajectoryFiles::add(const StampedPose& pose) {
  for (TrajectoryWriter& file : files_) file.add(pose);
}

void TrajectoryFiles::flush() {
  for (TrajectoryWriter& file : files_) file.flush();
}

RunWriter::RunWriter(const std::filesystem::path& folder, const OutputFrame& frame,
                     const std::vector<std::string>& comments)
    : frame_(frame), trajectory_(folder, comments), states_(folder / "states.csv", states_heading()) {
  trajectory_.flush();
}

void RunWriter::add(const Step& step) {
  states_.add(state_line(step));
  if (!is_tracking(step.status)) return;
  ++poses_;
  trajectory_.add(frame_({step.t, step.state.T_W_B}));
  trajectory_.flush();  // a kill must not leave a partial line
}

RunOutput states_output() {
  return always<StatesFiles>({"trajectory.tum", "trajectory_euroc.csv", "trajectory.kitti", "states.csv", "pace.csv"});
}

}  // namespace edged
