// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/states.hpp"

#include <optional>
#include <utility>

#include "common/files.hpp"
#include "report/states_table.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

constexpr const char* kKnownWhen =
    "causal: each estimated, as is the calibration, from the measurements up to its time";

class StatesFiles : public RunObserver {
 public:
  explicit StatesFiles(const RunContext& run) : run_(run) {}
  void on_begin() override {
    writer_.emplace(run_.folder, run_.frame.name(), run_.heading(run_.frame, kKnownWhen));
    pace_.emplace(run_.folder / "pace.csv", pace_heading());
  }
  void on_step(const Step& step) override {
    writer_->add(step);
    pace_->add(pace_line(step.t, run_.pace));
  }

 private:
  const RunContext& run_;
  std::optional<RunWriter> writer_;
  std::optional<TableFile> pace_;
};

}  // namespace

RunWriter::RunWriter(const std::filesystem::path& folder, std::string frame, const std::vector<std::string>& comments)
    : frame_(std::move(frame)), states_(folder / "states.csv", states_heading()) {
  trajectories_.emplace_back(folder / "trajectory.tum", TrajectoryFormat::Tum, comments);
  trajectories_.emplace_back(folder / "trajectory_euroc.csv", TrajectoryFormat::EurocCsv, comments);
  trajectories_.emplace_back(folder / "trajectory.kitti", TrajectoryFormat::Kitti, comments);
  for (TrajectoryWriter& file : trajectories_) file.flush();
}

void RunWriter::add(const Step& step) {
  states_.add(state_line(step));
  if (!is_tracking(step.status)) return;
  ++poses_;
  const StampedPose pose = step.pose_of(frame_);
  for (TrajectoryWriter& file : trajectories_) {
    file.add(pose);
    file.flush();  // a kill must not leave a partial line
  }
}

RunOutput states_output() {
  return always<StatesFiles>({"trajectory.tum", "trajectory_euroc.csv", "trajectory.kitti", "states.csv", "pace.csv"});
}

}  // namespace edged
