// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.hpp"
#include "common/interrupt.hpp"
#include "common/json_text.hpp"
#include "common/run_source.hpp"
#include "live/live_page.hpp"
#include "run/run.hpp"
#include "run/run_export.hpp"
#include "run/run_folder.hpp"
#include "run/run_many.hpp"
#include "run/run_map.hpp"
#include "run/run_occupancy.hpp"

namespace edged {
namespace {

int run(RunOptions options) {
  options.live = options.live || is_live(options.source);
  RunConfig config = load_config(options.config);
  config.odometry.map.localize_only = config.odometry.map.localize_only || options.map.localize_only;
  const bool by_default = config.odometry.cameras.empty() && config.odometry.stereo.enabled;
  if (config.odometry.cameras != kFirstCameras) options.source.cameras = camera_names(config.odometry.cameras);
  Source source = by_default ? open_run_source(options.source) : open_source(options.source);
  if (by_default) config.odometry.cameras = fmt::format("{}", fmt::join(options.source.cameras, ","));
  const Mode mode = choose_mode(options.mode, source.dataset->info());
  match_cameras(source, mode, options.source.cameras);
  for (const Modality modality : {Modality::Events, Modality::Frames})
    if (!uses(mode, modality)) source.dataset->leave_out(modality);
  const RunSummary summary = Run(options, std::move(source), mode, config).go();
  fmt::print("{}", options.json ? json_text(to_json(summary)) + "\n" : to_table(summary));
  for (const std::string& failure : summary.unwritten) spdlog::error(failure);
  if (interrupt_signal() != 0) return kExitSignalBase + interrupt_signal();
  if (!summary.unwritten.empty()) return kExitInput;
  if (summary.verdict.contradicted) return kExitNotTrusted;
  return summary.statistics.first_good_s() ? kExitOk : kExitNeverGood;
}

bool is_assignment(const std::string& word) {
  std::error_code ignored;
  return word.find('=') != std::string::npos && !std::filesystem::exists(word, ignored);
}

int run_all(const RunOptions& given, const CLI::App& app) {
  RunOptions options = given;
  std::vector<std::string> recordings = {options.source.recording}, assignments;
  for (const std::string& word : options.more) (is_assignment(word) ? assignments : recordings).push_back(word);
  if (recordings.size() > 1 && !options.map.save.empty())
    throw CLI::ValidationError("--save-map", "is for one recording; each would replace the map of the one before");
  if (recordings.size() > 1 && !options.archive.empty() && options.archive != kArchiveBeside)
    throw CLI::ValidationError("--archive",
                               "is one file, the recordings are several; leave =FILE out for one beside each folder");
  if (recordings.size() > 1 && !options.exports.folder.empty())
    throw CLI::ValidationError("--export", "is for one recording; each would replace the folder of the one before");
  if (recordings.size() > 1 && !options.occupancy.folder.empty())
    throw CLI::ValidationError("--occupancy", "is for one recording; each would replace the folder of the one before");
  if (recordings.size() > 1 && !options.mavlink.empty())
    throw CLI::ValidationError("--mavlink", "is for one recording: an autopilot flies one vehicle");
  if (recordings.size() > 1 && !options.serve.empty())
    throw CLI::ValidationError("--serve", "shows one run; give one recording (a port is written --serve=PORT)");
  if (recordings.size() > 1)
    return run_many({recordings, arguments_for_each(app, assignments), options.out, options.force, options.quiet,
                     options.json, options.jobs});
  options.config.assignments.insert(options.config.assignments.end(), assignments.begin(), assignments.end());
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
  add_map_options(*run_app, options->map);
  run_app->add_option("MORE", options->more, "More recordings, or options as KEY=VALUE (as with --set)");
  run_app->add_option("--mode", options->mode, "Sensors used beside the IMU; auto: all that are present")
      ->check(CLI::IsMember({"auto", "events", "frames", "fused"}))
      ->capture_default_str();
  run_app
      ->add_option("--frame", options->frame,
                   "Frame of the trajectory files: body, the name of a camera, or auto (the convention of the format)")
      ->capture_default_str();
  run_app->add_option(
      "--out", options->out,
      "Run folder; a number is appended if it holds a run [runs/NAME-MODE]; for several recordings the folder of "
      "their run folders");
  run_app->add_option("--jobs", options->jobs, "Number of recordings that run at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  run_app->add_flag("--force", options->force, "Overwrite an existing run folder (default: append a number)");
  run_app->add_flag(
      "--live", options->live,
      "Play at the speed of the recording, as from live sensors; if that is too fast, the oldest events are "
      "dropped (live.*); the "
      "depth network runs in its own thread; results are not bit-identical between runs");
  run_app->add_flag("--mcap", options->mcap,
                    "Also write results.mcap: poses, path, map, images and numbers for Foxglove, Lichtblick "
                    "and others (about 10 MB per minute)");
  add_export_options(*run_app, options->exports);
  run_app->add_flag(
      "--dense", options->dense,
      "Also write dense.ply: semi-dense points, at edges of frames and of event frames, placed by the "
      "final trajectory; in a thread of its own. With --live keyframes are left out that it is too slow for");
  add_occupancy_options(*run_app, options->occupancy);
  add_archive_option(*run_app, options->archive);
  add_serve_option(*run_app, options->serve);
  run_app->add_option(
      "--mavlink", options->mavlink,
      "With --live: send the odometry to an autopilot as MAVLink: udp:HOST:PORT, udpin:HOST:PORT (listens) "
      "or serial:DEVICE:BAUD; how the IMU is mounted, rate and ids: options autopilot.*");
  run_app->add_flag("--quiet", options->quiet, "No status line");
  run_app->add_flag("--json", options->json, "Print the summary as JSON");
  run_app->footer(
      "Examples:\n"
      "  edged run data/boxes_6dof --rig davis240c_ecd\n"
      "  edged run data/MH_01_easy --mode frames --out /tmp/mh01\n"
      "  edged run data/boxes_6dof data/poster_6dof --rig davis240c_ecd --jobs 2    # ends with a table\n"
      "  edged run data/boxes_6dof --live --set depth.source=fused\n"
      "  edged run tcp://127.0.0.1:7777 --calib head.yaml --serve    # a live camera, watched in a browser\n"
      "  edged run tcp://127.0.0.1:7777 --calib head.yaml --mavlink serial:/dev/ttyACM0:921600\n"
      "  edged run sim:room:3 --set packets.max_interval_s=0.03 --json --quiet\n"
      "  edged run sim:room:3:duration_s=20,disturbance.kind=lens-covered    # options of `edged simulate --list`\n"
      "  edged run events.raw --imu imu.csv --calib head.yaml --truth mocap.tum\n"
      "Of several recordings the exit code is that of the first whose is not 0.");
  run_app->callback(
      [options, run_app, &chosen] { chosen = [options, run_app] { return run_all(*options, *run_app); }; });
}

}  // namespace edged
