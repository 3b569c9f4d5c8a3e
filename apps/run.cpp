// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "edged/core/check.hpp"
#include "edged/io/zip_writer.hpp"
#include "final_trajectory_files.hpp"
#include "interrupt.hpp"
#include "json_text.hpp"
#include "kind_numbers.hpp"
#include "log.hpp"
#include "report_page.hpp"
#include "run_archive.hpp"
#include "serve_address.hpp"
#include "version.hpp"

namespace edged {
namespace {

/// Events and frames read before they are wanted: a packet of a wide sensor in haste, and little beside what a run
/// holds.
constexpr int kReadAheadMegabytes = 16;

std::filesystem::path run_folder_path(const RunOptions& options, const DatasetInfo& info, Mode mode) {
  if (!options.out.empty()) return options.out;
  return std::filesystem::path("runs") / (info.name + "-" + mode_name(mode));
}

/// What was asked for, or what the format's users expect, where the calibration has that.
std::string frame_name(const std::string& wanted, const Source& source) {
  const std::string& usual = source.dataset->info().pose_frame;
  const bool has_usual = std::ranges::count(source.calibration.rig.cameras, usual, &RigCamera::name) > 0;
  return wanted != "auto" ? wanted : has_usual ? usual : "body";
}

/// What the live page calls the run.
nlohmann::ordered_json about_run(const Source& source, Mode mode, const OutputFrame& frame) {
  const DatasetInfo& info = source.dataset->info();
  const bool ends = info.begin && info.end;
  return {{"version", kVersion},
          {"recording", info.name},
          {"format", info.format},
          {"mode", mode_name(mode)},
          {"frame", frame.name()},
          {"whole_s", ends ? nlohmann::ordered_json(to_seconds(*info.end - *info.begin)) : nlohmann::ordered_json()}};
}

std::string options_text(RunConfig config) { return ConfigFields::of(config).to_yaml(); }

/// Tells whether two runs had the same options (FNV-1a, 64 bit).
std::string hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

std::string config_text(const std::string& options, const DatasetInfo& info, Mode mode) {
  return fmt::format(
             "# every option of this run; give it to --config to repeat it\n# recording {}, mode {}, edged {}\n",
             info.name, mode_name(mode), kVersion) +
         options;
}

std::string run_status(const RunStatistics& statistics, const Verdict& verdict) {
  if (interrupt_signal() != 0) return "interrupted";
  if (!statistics.first_good_s()) return "never good";
  if (verdict.contradicted && is_tracking(statistics.last_status())) return "not to be trusted";
  switch (statistics.last_status()) {
    case TrackingStatus::Good:
      return "good";
    case TrackingStatus::Degraded:
      return "degraded";
    case TrackingStatus::Lost:
      return "lost";
    case TrackingStatus::Initializing:
      return "lost, initializing again";
  }
  EDGED_CHECK(false, "status {}", static_cast<int>(statistics.last_status()));
}

/// In a line; empty where nothing is.
std::string what_is_wrong(const RunSummary& summary) {
  const auto error = std::ranges::find(summary.verdict.findings, Severity::Error, &Finding::severity);
  const std::string because = error != summary.verdict.findings.end() ? error->text : summary.verdict.waiting_for;
  const double silent_s = summary.consistency ? summary.consistency->silent_s() : 0.0;
  if (!summary.verdict.trusted)
    return because.starts_with(summary.status) ? because : fmt::format("{}: {}", summary.status, because);
  if (silent_s > 0.0) return fmt::format("farther off than it says for {:.1f} s", silent_s);
  return summary.statistics.times_lost() > 0 ? fmt::format("lost {} times", summary.statistics.times_lost()) : "";
}

}  // namespace

Run::Run(const RunOptions& options, Source source, Mode mode, const RunConfig& config)
    : options_(options),
      source_(std::move(source)),
      mode_(mode),
      frame_(source_.calibration.rig, frame_name(options.frame, source_)),
      used_(used_cameras(source_.calibration.rig, mode_, config.odometry.cameras)),
      check_(source_.dataset->info(), source_.calibration, used_),
      folder_(run_folder_path(options, source_.dataset->info(), mode_)),
      odometry_(source_.calibration.rig, source_.calibration.imu, mode_, config.odometry,
                {kInOrder, options.live ? Inference::OwnThread : Inference::Synchronous}),
      map_(options.map, config.odometry.map.enabled, odometry_),
      queue_config_(config.live),
      calibration_config_(config.odometry.estimator.calibration),
      status_line_(options.quiet) {
  const DatasetInfo& info = source_.dataset->info();
  if (options.live && source_.seed)
    throw InputError::format("--live replays a recording; write one first: edged simulate --preset {}", info.name);
  if (!options.serve.empty())
    page_.emplace(*parse_serve_address(options.serve), about_run(source_, mode_, frame_), frame_);
  const EarlierRun earlier = options.force ? EarlierRun::Replace : EarlierRun::Keep;
  if (!options.archive.empty() && options.archive != kArchiveBeside)
    check_archive(archive_ = options.archive, earlier);  // before there is a folder
  const std::filesystem::path wanted = folder_;
  folder_ = make_run_folder(wanted, earlier);
  if (options.archive == kArchiveBeside) {
    try {
      check_archive(archive_ = beside(folder_, ".zip"), earlier);
    } catch (const InputError&) {
      give_back_run_folder(folder_);
      throw;
    }
  }
  const std::string resolved = options_text(config);
  write_file(folder_ / "config_resolved.yaml", config_text(resolved, info, mode_));
  write_file(folder_ / "calibration.yaml", to_yaml(source_.calibration));
  attach_log_file(folder_ / "run.log");
  if (folder_ != wanted)
    spdlog::warn(fmt::format("{}: holds an earlier run; this one goes to {} (--force replaces)", wanted.string(),
                             folder_.string()));
  spdlog::info(fmt::format("edged {}: {} ({}), mode {}", kVersion, info.name, info.format, mode_name(mode_)));
  spdlog::info(describe(source_.calibration));
  if (options.mcap)
    mcap_.emplace(folder_ / "results.mcap", odometry_.rig(),
                  RunFacts{{"version", kVersion},
                           {"recording", info.name},
                           {"format", info.format},
                           {"mode", mode_name(mode_)},
                           {"options", resolved},
                           {"options_hash", hash_of(resolved)},
                           {"calibration", to_yaml(source_.calibration)}});
  writer_.emplace(folder_, frame_, headed("causal: each as it was known at its time"));
  pace_writer_.emplace(folder_);
}

/// Comments at the head of a trajectory file.
std::vector<std::string> Run::headed(const std::string& known_when) const {
  return {fmt::format("{}; {}", frame_.describe(), known_when),
          fmt::format("edged {}, recording {}, mode {}", kVersion, source_.dataset->info().name, mode_name(mode_))};
}

/// What contradicts is told as soon as it is known: who watches can stop there.
void Run::check(const Measurement& measurement) {
  const auto timer = program_timings_.measure_often("check");
  check_.add(measurement);
  for (const Finding& finding : check_.news()) spdlog::error(fmt::format("{}: {}", finding.text, finding.remedy));
}

void Run::observe(const Step& step) {
  pace_.processing_ms = 1e3 * odometry_.timings().find("process")->last_s();
  if (live_) pace_.latency_ms = 1e3 * live_->note_result(step.t);
  log_changes(step);
  map_.observe(step, odometry_);
  {
    const auto timer = program_timings_.measure("write");
    statistics_.add(step);
    writer_->add(step);
    pace_writer_->add(step.t, pace_);
    moment_.consider(step);
    album_.add(step);
  }
  if (mcap_) {
    const auto timer = program_timings_.measure("mcap");
    mcap_->add(step, album_);
  }
  if (page_) {
    const auto timer = program_timings_.measure("serve");
    page_->add(step, progress(), album_);
  }
  if (status_line_.due()) show_status(step);
}

/// Before the statistics know the step.
void Run::log_changes(const Step& step) const {
  const double t_s = to_seconds(step.t);
  if (!step.started.empty()) spdlog::info(fmt::format("{:.3f} s: started {}", t_s, step.started));
  if (step.relocalized) spdlog::info(fmt::format("{:.3f} s: found again in the map", t_s));
  if (step.status == statistics_.last_status()) return;
  if (step.status == TrackingStatus::Lost) {
    spdlog::warn(fmt::format("lost at {:.3f} s: {}; starting again", t_s, step.lost_because));
  }
  spdlog::info(fmt::format("{:.3f} s: {}", t_s, to_string(step.status)));
}

void Run::show_status(const Step& step) {
  const DatasetInfo& info = source_.dataset->info();
  const double done_s = statistics_.visual_span_s();
  std::string text = info.begin && info.end ? fmt::format("{:.1f} / {:.1f} s", to_seconds(step.t - *info.begin),
                                                          to_seconds(*info.end - *info.begin))
                                            : fmt::format("{:.1f} s", done_s);
  text += fmt::format("  {:.1f}x", done_s / meter_.wall_s());
  if (mode_ != Mode::Frames) {
    const KindNumbers events = numbers_of(step, Modality::Events);
    text += fmt::format("  {}ev/s  event tracks {}", si_number(events.event_rate_hz), events.tracks);
  }
  if (mode_ != Mode::Events) text += fmt::format("  frame tracks {}", numbers_of(step, Modality::Frames).tracks);
  text += "  " + to_string(step.status);
  if (!step.waiting_for.empty()) text += ", waits for " + step.waiting_for;
  status_line_.show(text);
}

std::optional<Measurement> Run::read() {
  const auto timer = program_timings_.measure_often(source_.seed ? "simulate" : "wait");
  if (live_) return live_->next();
  if (reader_) return reader_->next();
  return meter_.without([this] { return source_.dataset->next(); });
}

std::optional<Measurement> Run::next_measurement() {
  if (interrupt_signal() != 0) return std::nullopt;
  std::optional<Measurement> measurement = read();
  if (!measurement) return measurement;
  check(*measurement);
  statistics_.add_visual(*measurement, used_);
  return measurement;
}

void Run::start_reading() {
  const auto interrupted = [] { return interrupt_signal() != 0; };
  // The price of making up a recording is no part of what it costs to estimate one: that is not done beside.
  if (source_.seed) return;
  if (options_.live) {
    live_.emplace(*source_.dataset, queue_config_, interrupted);
  } else {
    reader_.emplace(*source_.dataset, QueueConfig{.max_megabytes = kReadAheadMegabytes}, WhenFull::Wait, interrupted);
  }
}

/// The dataset is no longer read.
void Run::stop_reading() {
  if (live_) live_->stop();
  if (reader_) reader_->stop();
  if (live_ || reader_) program_timings_.put("read", live_ ? live_->reading() : reader_->reading());
}

RunSummary Run::go() {
  catch_interrupts();
  if (page_) fmt::print(stderr, "edged: watch at {}\n", page_->url());
  meter_ = ResourceMeter();
  start_reading();
  try {
    drive(
        odometry_, [this] { return next_measurement(); },
        [this](const Step& step) {
          observe(step);
          return interrupt_signal() == 0;
        });
  } catch (const std::exception& e) {
    // What came before it stays, in complete files.
    spdlog::info(fmt::format("broken off: {}", e.what()));  // main tells the user
    broken_off_ = true;
    summarize();
    throw;
  }
  return summarize();
}

FinalTrajectory Run::final_trajectory() {
  const auto timer = program_timings_.measure("final_trajectory");
  return odometry_.final_trajectory();
}

RunSummary Run::summarize() {
  stop_reading();
  status_line_.clear();
  const DatasetInfo& info = source_.dataset->info();
  RunSummary summary;
  summary.wall_s = meter_.wall_s();
  summary.cpu_s = meter_.cpu_s();
  summary.recording = info.name;
  summary.format = info.format;
  summary.mode = mode_name(mode_);
  summary.frame = frame_.name();
  summary.folder = folder_.string();
  summary.archive = archive_.string();
  summary.seed = source_.seed;
  summary.statistics = statistics_;
  summary.poses = writer_->poses();
  summary.calibration = compare_calibrations(source_.calibration.rig, odometry_, calibration_config_);
  const std::optional<GroundTruth> truth = source_.dataset->ground_truth();
  summary.verdict =
      judge_run(check_.findings(*source_.dataset, truth), statistics_, summary.calibration, options_.source);
  summary.map = map_.finish(odometry_);
  summary.status = broken_off_ ? "broken off" : run_status(statistics_, summary.verdict);
  if (live_)
    summary.live =
        LiveSummary{live_->latency(), live_->shed(), odometry_.counters().packets.packets_overflow, live_->peaks()};
  summary.repairs = source_.dataset->repairs();
  add_dropped(summary.repairs, odometry_.counters());
  const FinalTrajectory known = final_trajectory();
  write_final_trajectory(folder_, frame_, known, headed("final: each by all that was found again before and after"));
  const StatesTable states = read_states(folder_);
  const Trajectory body = map_.in_one_frame(body_poses(states));
  if (truth && !body.empty())
    evaluate_run(summary, body, covariance_samples_of(states), source_.calibration.rig, *truth);
  if (summary.evaluation) evaluate_final(summary, map_.in_one_frame(known.poses), source_.calibration.rig, *truth);
  summary.peak_rss_mb = ResourceMeter::peak_rss_mb();
  write_file(folder_ / "timing.json", timing_json(odometry_.timings(), program_timings_));
  write_file(folder_ / "metrics.json", json_text(to_json(summary)) + "\n");
  const ReportPath path = lay_onto_truth(body, {}, source_.calibration.rig, frame_.name(), truth, {});
  write_overview(summary, path);
  if (mcap_) finish_mcap(summary, known, path);
  album_.write(folder_, source_.calibration, odometry_.rig(), truth);
  for (const auto& [kind, count] : summary.repairs) spdlog::info(fmt::format("repaired: {} x {}", count, kind));
  for (const Finding& finding : summary.verdict.findings)
    spdlog::info(fmt::format("found: {}: {}", finding.text, finding.remedy));
  spdlog::info(
      fmt::format("status {}, {} poses, {} keyframes", summary.status, summary.poses, summary.statistics.keyframes()));
  write_run_report(folder_);  // the log is part of it
  if (page_) page_->finish(progress(), to_json(summary), folder_);
  if (!archive_.empty()) zip_folder(archive_, folder_);  // may fail, on a full disk
  return summary;
}

void Run::finish_mcap(const RunSummary& summary, const FinalTrajectory& known, const ReportPath& path) {
  const OutputFrame sensor(source_.calibration.rig, path.frame);
  const SE3 T_estimate_truth = path.alignment.T.inverse();
  Trajectory true_body;
  for (const StampedPose& pose : path.true_path)
    true_body.push_back(sensor.to_body({pose.t, T_estimate_truth * pose.T}));
  mcap_->finish(known, album_, true_body, summary);
}

void Run::write_overview(const RunSummary& summary, const ReportPath& path) const {
  OverviewContent content;
  content.title = fmt::format("{}, {}", summary.recording, summary.mode);
  content.wrong = what_is_wrong(summary);
  content.moment = moment_;
  content.changes = album_.changes();
  content.end = album_.last();
  const Duration clock = path.body.empty() ? Duration(0) : path.shown.front().t - path.body.front().t;  // that sensor's
  for (StatusChange& change : content.changes) change.t += clock;
  content.estimate = path.shown;
  content.truth = path.true_path;
  if (path.evaluation) {
    const Evaluation& e = *path.evaluation;
    content.title += fmt::format(": ATE {:.1f} mm over {:.1f} m", 1e3 * e.ate_m.rmse, e.path_length_m);
    content.error_m = path.error_m;
  }
  std::vector<unsigned char> png;
  cv::imencode(".png", draw_overview(content), png);
  write_file(folder_ / "overview.png", std::string(png.begin(), png.end()));
}

}  // namespace edged
