// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <system_error>

#include "common/files.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "edged/core/check.hpp"
#include "edged/io/archive/zip_writer.hpp"
#include "program.hpp"
#include "report/states_table.hpp"
#include "run/run_folder.hpp"
#include "run/run_reader.hpp"

namespace edged {
namespace {

std::filesystem::path run_folder_path(const RunContext& run) {
  if (!run.options.out.empty()) return run.options.out;
  return std::filesystem::path("runs") / (run.info().name + "-" + mode_name(run.mode));
}

std::string config_text(const RunContext& run) {
  return fmt::format(
             "# every option of this run; give it to --config to repeat it\n# recording {}, mode {}, edged {}\n",
             run.info().name, mode_name(run.mode), kVersion) +
         options_text(run.config);
}

RunSummary facts_of(const RunContext& run) {
  RunSummary summary;
  summary.wall_s = run.meter.wall_s();
  summary.cpu_s = run.meter.cpu_s();
  summary.recording = run.info().name;
  summary.format = run.info().format;
  summary.mode = mode_name(run.mode);
  summary.frame = run.frame.name();
  summary.folder = run.folder.string();
  summary.archive = run.archive.string();
  summary.seed = run.source.seed;
  summary.statistics = run.statistics;
  summary.poses = run.statistics.poses();
  summary.repairs = run.source.dataset->repairs();
  add_dropped(summary.repairs, run.odometry.counters());
  return summary;
}

}  // namespace

Run::Run(const RunOptions& options, Source source, Mode mode, const RunConfig& config)
    : run_(options, std::move(source), mode, config), truth_(read_truth(*run_.source.dataset)) {
  if (options.live && run_.source.seed)
    throw InputError::format("--live replays a recording; write one first: edged simulate --preset {}",
                             run_.info().name);
  observers_ = make_observers(run_);
  make_folder();
}

void Run::make_folder() {
  const EarlierRun earlier = run_.options.force ? EarlierRun::Replace : EarlierRun::Keep;
  const std::string& archive = run_.options.archive;
  if (!archive.empty() && archive != kArchiveBeside)
    check_archive(run_.archive = archive, earlier);  // before the folder exists
  const std::filesystem::path wanted = run_folder_path(run_);
  run_.folder = make_run_folder(wanted, earlier);
  if (archive == kArchiveBeside) {
    try {
      check_archive(run_.archive = beside(run_.folder, ".zip"), earlier);
    } catch (const InputError&) {
      give_back_run_folder(run_.folder);
      throw;
    }
  }
  write_file(run_.folder / "config_resolved.yaml", config_text(run_));
  write_file(run_.folder / "calibration.yaml", to_yaml(run_.source.calibration));
  attach_log_file(run_.folder / "run.log");
  if (run_.folder != wanted)
    spdlog::warn(fmt::format("{}: holds an earlier run; this one goes to {} (--force replaces)", wanted.string(),
                             run_.folder.string()));
  const DatasetInfo& info = run_.info();
  spdlog::info(fmt::format("edged {}: {} ({}), mode {}", kVersion, info.name, info.format, mode_name(run_.mode)));
  spdlog::info(describe(run_.source.calibration));
  if (!truth_.problem.empty())
    spdlog::warn(fmt::format("the ground truth cannot be read, so nothing is compared with it: {}", truth_.problem));
}

RunSummary Run::go() {
  catch_interrupts();
  for (const auto& observer : observers_) observer->on_begin();
  run_.meter = ResourceMeter();
  RunReader reader(run_, [this](const Measurement& measurement) {
    for (const auto& observer : observers_) observer->on_due(measurement);
  });
  try {
    drive(
        run_.odometry, [&] { return next_measurement(reader); },
        [&](const Step& step) {
          observe(step, reader);
          return interrupt_signal() == 0;
        });
  } catch (const std::exception& e) {
    // Earlier results stay, in complete files.
    spdlog::info(fmt::format("broken off: {}", e.what()));  // main reports it
    finish(reader, true);
    throw;
  }
  return finish(reader, false);
}

std::optional<Measurement> Run::next_measurement(RunReader& reader) {
  std::optional<Measurement> measurement = reader.next();
  if (!measurement) return measurement;
  for (const auto& observer : observers_) observer->on_measurement(*measurement);
  run_.statistics.add_visual(*measurement, run_.used);
  return measurement;
}

void Run::observe(const Step& step, RunReader& reader) {
  run_.pace.processing_ms = 1e3 * run_.odometry.timings().find("process")->last_s();
  if (const auto latency_s = reader.note_result(step.t)) run_.pace.latency_ms = 1e3 * *latency_s;
  run_.statistics.add(step);
  for (auto next = observers_.begin(); next != observers_.end();) {
    const std::string stage = (*next)->stage();
    const auto timer = run_.timings.measure(stage);
    for (; next != observers_.end() && (*next)->stage() == stage; ++next) (*next)->on_step(step);
  }
}

RunSummary Run::finish(RunReader& reader, bool broken_off) {
  reader.stop();
  RunEnd end = summarize(reader, broken_off);
  std::vector<std::string> unwritten;
  // One that fails, on a full disk, costs no other.
  const auto attempt = [&unwritten](const auto& write) {
    try {
      write();
    } catch (const InputError& e) {
      unwritten.emplace_back(e.what());
    } catch (const std::system_error& e) {
      unwritten.emplace_back(e.what());
    }
  };
  for (const auto& observer : observers_) attempt([&] { observer->on_end(end); });
  if (!run_.archive.empty()) attempt([&] { zip_folder(run_.archive, run_.folder); });
  end.summary.unwritten = std::move(unwritten);
  return end.summary;
}

RunEnd Run::summarize(const RunReader& reader, bool broken_off) {
  RunEnd end;
  end.summary = facts_of(run_);
  end.summary.live = reader.live_summary();
  end.truth = truth_.truth;
  if (!truth_.problem.empty())
    end.summary.verdict.findings.push_back({Severity::Warning, "ground truth: cannot be read: " + truth_.problem,
                                            "mend or remove the file: the run is compared with nothing"});
  for (const auto& observer : observers_) observer->on_summary(end);
  {
    const auto timer = run_.timings.measure("final_trajectory");
    end.known = run_.odometry.final_trajectory();
  }
  compare_with_truth(end);
  const Ending ending = broken_off                ? Ending::BrokenOff
                        : interrupt_signal() != 0 ? Ending::Interrupted
                                                  : Ending::Complete;
  judge_run(end.summary, run_.options.source, ending);
  end.summary.peak_rss_mb = ResourceMeter::peak_rss_mb();
  return end;
}

void Run::compare_with_truth(RunEnd& end) const {
  const auto in_one_frame = [&end](Trajectory poses) {
    if (end.in_map_since) std::erase_if(poses, [&](const StampedPose& pose) { return pose.t < *end.in_map_since; });
    return poses;
  };
  const Rig rig = run_.found_rig();
  const StatesTable states = read_states(run_.folder);
  const Trajectory body = in_one_frame(body_poses(states));
  if (end.truth && !body.empty()) evaluate_run(end.summary, body, covariance_samples_of(states), rig, *end.truth);
  if (end.summary.evaluation) evaluate_final(end.summary, in_one_frame(end.known.poses), rig, *end.truth);
  end.path = lay_onto_truth(body, {}, rig, run_.frame.name(), end.truth, {});
}

}  // namespace edged
