// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --dense of `edged run`: semi-dense depth beside the odometry, dense.ply at the end.
#include <functional>
#include <memory>
#include <utility>

#include "common/files.hpp"
#include "edged/dense/dense_worker.hpp"
#include "run/dense_scan.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

class RunDense : public RunObserver {
 public:
  explicit RunDense(RunContext& run)
      : run_(run),
        images_(image_cameras(run.used)),
        worker_({}, run.options.live ? DenseOverload::Drop : DenseOverload::Wait, show_in(run)) {}

  void on_step(const Step& step) override {
    restart_ = restart_ || !is_tracking(step.status) || !step.started.empty();
    if (!is_tracking(step.status)) return;
    if (step.keyframe && !run_.options.serve.empty()) run_.live_points.note_keyframe(step.t, step.T_M_O);
    DenseInstant instant = dense_instant(step, images_, run_.odometry.rig());
    instant.restart = std::exchange(restart_, false);
    worker_.add(std::move(instant));
  }

  void on_summary(RunEnd& end) override {
    worker_.finish();
    run_.timings.put("dense", worker_.timing());
    const DenseCounters& counters = worker_.mapper().counters();
    end.summary.dense = DenseSummary{counters.keyframes, counters.unmeasured, worker_.dropped_keyframes(),
                                     counters.edges, counters.with_depth};
  }

  void on_end(const RunEnd& end) override {
    run_.dense = place(worker_.mapper().maps(), end.known.poses, run_.odometry.rig());
    write_file(run_.folder / "dense.ply", dense_ply(run_.dense));
  }

 private:
  static std::function<void(const DepthMap&)> show_in(RunContext& run) {
    if (run.options.serve.empty()) return {};
    return [&run](const DepthMap& map) { run.live_points.add(map); };
  }

  RunContext& run_;
  std::vector<RigCamera> images_;
  bool restart_ = false;
  DenseWorker worker_;
};

}  // namespace

std::unique_ptr<RunObserver> observe_dense(RunContext& run) {
  return run.options.dense ? std::make_unique<RunDense>(run) : nullptr;
}

}  // namespace edged
