// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/source.hpp"
#include "common/text.hpp"
#include "edged/io/core/camera_names.hpp"
#include "run/run.hpp"
#include "run/run_folder.hpp"
#include "run_outputs.hpp"

namespace edged {
namespace {

/// Opens the recording with the cameras that options.cameras names, else with those of stereo_cameras(), which it puts
/// there; of a live source, of the simulator, and where not all cameras can be read, with the first of each kind.
Source open_run_source(SourceOptions& options) {
  if (!options.cameras.empty() || is_live(options) || simulator_config(options)) return open_source(options);
  std::optional<HeldWarnings> of_all_cameras;  // which may be opened again, with those of the run: said once then
  const auto open = [&](const std::vector<std::string>& cameras, bool all) {
    if (of_all_cameras) of_all_cameras->take();
    of_all_cameras.reset();
    if (all) of_all_cameras.emplace();
    SourceOptions chosen = options;
    chosen.cameras = cameras;
    chosen.all_cameras = all;
    return open_uncalibrated(chosen);
  };
  std::vector<std::string> cameras;
  Recording recording = open_with_stereo_cameras(open, cameras);
  of_all_cameras.reset();
  options.cameras = cameras;
  return calibrated(options, std::move(recording));
}

int run(RunOptions options) {
  options.live = options.live || is_live(options.source);
  RunConfig config = load_config(options.config);
  config.odometry.map.localize_only = config.odometry.map.localize_only || options.localize_only;
  const bool by_default = config.odometry.cameras.empty() && config.odometry.stereo.enabled;
  if (config.odometry.cameras != kFirstCameras) options.source.cameras = camera_names(config.odometry.cameras);
  Source source = by_default ? open_run_source(options.source) : open_source(options.source);
  if (by_default) config.odometry.cameras = fmt::format("{}", fmt::join(options.source.cameras, ","));
  const Mode mode = choose_mode(options.mode, source.dataset->info());
  match_cameras(source, mode, options.source.cameras);
  for (const Modality modality : {Modality::Events, Modality::Frames})
    if (!uses(mode, modality)) source.dataset->leave_out(modality);
  RunContext context(options, std::move(source), mode, config);
  const RunSummary summary = Run(context, run_outputs()).go();
  print_result(options.json, to_json(summary), to_table(summary));
  for (const std::string& failure : summary.unwritten) spdlog::error(failure);
  if (interrupt_signal() != 0) return exit_code_of_interrupt();
  if (summary.verdict.contradicted) return kExitNotTrusted;
  if (!summary.unwritten.empty()) return kExitInput;
  return summary.statistics.first_good_s() ? kExitOk : kExitNeverGood;
}

/// MORE: options as KEY=VALUE. Another recording is refused with the loop that runs several.
int run_with(const RunOptions& given) {
  RunOptions options = given;
  for (const std::string& word : options.more)
    if (word.find('=') == std::string::npos)
      throw CLI::ValidationError(
          word,
          fmt::format("is not KEY=VALUE, and a run takes one recording; run several in a loop of the shell: "
                      "for r in {} {}; do edged run \"$r\"; done (the value of a flag follows =, as in --serve=PORT)",
                      shell_word(options.source.recording), shell_word(word)));
  options.config.assignments.insert(options.config.assignments.end(), options.more.begin(), options.more.end());
  return run(std::move(options));
}

}  // namespace

void add_run_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* run_app = app.add_subcommand("run", "Estimate the trajectory of a recording and write a run folder");
  add_source_options(*run_app, options->source);
  run_app->add_option("--truth", options->source.truth,
                      "Ground truth to compare with, instead of the recording's own: a trajectory of the body [or of "
                      "the sensor of the recording's own] on the recording's clock, in any format of `edged eval`");
  add_config_options(*run_app, options->config);
  run_app->add_option("MORE", options->more, "Options as KEY=VALUE (as with --set)");
  run_app->add_option("--mode", options->mode, "Sensors used beside the IMU; auto: all that are present")
      ->check(CLI::IsMember({"auto", "events", "frames", "fused"}))
      ->capture_default_str();
  run_app
      ->add_option("--frame", options->frame,
                   "Frame of the trajectory files: body, the name of a camera, or auto (the convention of the format)")
      ->capture_default_str();
  run_app->add_option("--out", options->out, "Run folder; a number is appended if it holds a run [runs/NAME-MODE]");
  run_app->add_flag("--force", options->force, "Overwrite an existing run folder (default: append a number)");
  run_app->add_flag(
      "--live", options->live,
      "Play at the speed of the recording, as from live sensors; if that is too fast, the oldest events are "
      "dropped (live.*); the "
      "depth network runs in its own thread; results are not bit-identical between runs");
  run_app->add_flag("--localize-only", options->localize_only,
                    "With --map: never change the map, and write poses only while localized in it (option "
                    "map.localize_only)");
  add_archive_option(*run_app, options->archive);
  for (const RunOutput& output : run_outputs())
    if (output.add_options) output.add_options(*run_app, options->outputs);
  finish_command(
      *run_app, options,
      "Examples:\n"
      "  edged run data/boxes_6dof --rig davis240c_ecd\n"
      "  edged run data/MH_01_easy --mode frames --out /tmp/mh01\n"
      "  edged run data/boxes_6dof --live --set depth.source=fused\n"
      "  edged run tcp://127.0.0.1:7777 --calib head.yaml --serve    # a live camera, watched in a browser\n"
      "  edged run tcp://127.0.0.1:7777 --calib head.yaml --mavlink serial:/dev/ttyACM0:921600\n"
      "  edged run sim:room:3 --set packets.max_interval_s=0.03 --json --quiet\n"
      "  edged run sim:room:3:duration_s=20,disturbance.kind=lens-covered    # options of `edged simulate --list`\n"
      "  edged run events.raw --imu imu.csv --calib head.yaml --truth mocap.tum",
      chosen, run_with);
}

}  // namespace edged
