// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --dense of `edged run`: semi-dense depth beside the odometry, dense.ply at the end.
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <utility>

#include "common/files.hpp"
#include "common/text.hpp"
#include "edged/dense/dense_worker.hpp"
#include "run/run_context.hpp"
#include "scene/dense_scan.hpp"
#include "scene/live_points.hpp"

namespace edged {
namespace {

struct DenseOptions {
  bool wanted = false;
};

class RunDense : public RunObserver {
 public:
  explicit RunDense(RunContext& run)
      : run_(run),
        images_(image_cameras(run.used)),
        scans_(run.products.get<DenseScans>()),
        viewed_(run.products.get<LivePoints>()),
        worker_({}, run.options.live ? DenseOverload::Drop : DenseOverload::Wait, [this](const DepthMap& map) {
          if (viewed_.watched) viewed_.add(map);
        }) {
    viewed_.has_points = true;
  }

  void on_step(const Step& step) override {
    restart_ = restart_ || !is_tracking(step.status) || !step.started.empty();
    if (!is_tracking(step.status)) return;
    if (step.keyframe && viewed_.watched) viewed_.note_keyframe(step.t, step.T_M_O);
    DenseInstant instant = dense_instant(step, images_, run_.rig);
    instant.restart = std::exchange(restart_, false);
    worker_.add(std::move(instant));
  }

  void on_summary(RunEnd& end) override {
    worker_.finish();
    run_.timings.put("dense", worker_.timing());
    add_figures(end.summary.outputs, worker_.mapper().counters(), worker_.dropped_keyframes());
  }

  void on_end(const RunEnd& end) override {
    scans_ = place(worker_.mapper().maps(), end.final_trajectory.poses, run_.rig);
    write_file(run_.folder / "dense.ply", dense_ply(scans_));
  }

 private:
  static void add_figures(Figures& figures, const DenseCounters& counted, std::size_t dropped) {
    const double edges = static_cast<double>(std::max<std::size_t>(1, counted.edges));
    figures.json["dense"] = {{"keyframes", counted.keyframes},
                             {"without_parallax", counted.unmeasured},
                             {"dropped", dropped},
                             {"edge_pixels", counted.edges},
                             {"with_depth", counted.with_depth}};
    figures.line("dense depth", quantity(counted.keyframes, "keyframe"),
                 fmt::format("{:.0f} % of their edge pixels; {} without parallax{}; dense.ply",
                             100.0 * static_cast<double>(counted.with_depth) / edges, counted.unmeasured,
                             dropped > 0 ? fmt::format("; {} left out: too slow", dropped) : ""));
  }

  RunContext& run_;
  std::vector<RigCamera> images_;
  bool restart_ = false;
  DenseScans& scans_;
  LivePoints& viewed_;
  DenseWorker worker_;
};

}  // namespace

RunOutput dense_output() {
  return {{"dense.ply"},
          [](CLI::App& command, Board& options) {
            command.add_flag(
                "--dense", options.get<DenseOptions>().wanted,
                "Also write dense.ply: semi-dense points, at edges of frames and of event frames, placed by the final "
                "trajectory; in a thread of its own. With --live keyframes are left out that it is too slow for");
          },
          [](RunContext& run) -> std::unique_ptr<RunObserver> {
            if (!run.options.outputs.get<DenseOptions>().wanted) return nullptr;
            return std::make_unique<RunDense>(run);
          }};
}

}  // namespace edged
