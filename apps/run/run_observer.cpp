// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_observer.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "program.hpp"
#include "report/report_page.hpp"
#include "run/verdict.hpp"

namespace edged {
namespace {

constexpr std::array kObservers = {
    observe_autopilot,  // first, as it is not to wait for the others
    observe_status_line,
    observe_log,
    observe_verdict,
    observe_map,
    observe_states,
    observe_external,
    observe_summary,  // before large outputs, and those that `edged report` can write again
    observe_album,    // which those below use
    observe_final_trajectory,
    observe_export,
    observe_dense,
    observe_occupancy,  // of the points of the one above, too
    observe_overview,
    observe_report,  // of the files of those above
    observe_mcap,
    observe_live_page,
};

/// The chosen frame, or the convention of the format, if the calibration has that.
std::string frame_name(const std::string& wanted, const Source& source) {
  const std::string& usual = source.dataset->info().pose_frame;
  const bool has_usual = std::ranges::count(source.calibration.rig.cameras, usual, &RigCamera::name) > 0;
  return wanted != "auto" ? wanted : has_usual ? usual : "body";
}

class ReportFile : public RunObserver {
 public:
  explicit ReportFile(const RunContext& run) : run_(run) {}
  void on_end(const RunEnd&) override { write_run_report(run_.folder); }

 private:
  const RunContext& run_;
};

}  // namespace

RunContext::RunContext(const RunOptions& run_options, Source recording, Mode run_mode, const RunConfig& run_config)
    : options(run_options),
      source(std::move(recording)),
      mode(run_mode),
      config(run_config),
      frame(source.calibration.rig, frame_name(options.frame, source)),
      used(used_cameras(source.calibration.rig, mode, config.odometry.cameras)),
      odometry(source.calibration.rig, source.calibration.imu, mode, config.odometry,
               {kInOrder, options.live ? Inference::OwnThread : Inference::Synchronous}) {}

Rig RunContext::found_rig() const {
  return rig_for_poses(source.calibration.rig, with_found(source.calibration, odometry.rig()).rig);
}

std::vector<std::string> RunContext::heading(const OutputFrame& of, const std::string& known_when) const {
  return {fmt::format("{}; {}", of.describe(), known_when),
          fmt::format("edged {}, recording {}, mode {}", kVersion, info().name, mode_name(mode))};
}

std::vector<std::unique_ptr<RunObserver>> make_observers(RunContext& run) {
  std::vector<std::unique_ptr<RunObserver>> observers;
  for (ObserverFactory* make : kObservers)
    if (auto observer = make(run)) observers.push_back(std::move(observer));
  return observers;
}

std::unique_ptr<RunObserver> observe_report(RunContext& run) { return std::make_unique<ReportFile>(run); }

}  // namespace edged
