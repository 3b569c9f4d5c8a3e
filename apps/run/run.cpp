// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <system_error>
#include <utility>

#include "common/cli.hpp"
#include "common/files.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "edged/io/archive/source_path.hpp"
#include "run/run_folder.hpp"
#include "run/run_reader.hpp"
#include "run/verdict.hpp"

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

RunSummary begin_summary(const RunContext& run) {
  RunSummary summary;
  const OdometryConfig& config = run.config.odometry;
  summary.run = {run.info().name,  run.info().format,        mode_name(run.mode),
                 run.frame.name(), run.folder.string(),      run.archive.string(),
                 run.source.seed,  config.map.localize_only, config.status.max_scale_sigma};
  summary.resources = {run.meter.wall_s(), run.meter.cpu_s()};
  summary.statistics = run.statistics;
  summary.repairs = run.source.dataset->repairs();
  summary.imu_clock = found_imu_clock(run.options.source);
  return summary;
}

/// What a later run in the folder may replace.
std::vector<const char*> files_of(const std::vector<RunOutput>& outputs) {
  std::vector<const char*> files{"calibration.yaml", "run.log"};
  for (const RunOutput& output : outputs) files.insert(files.end(), output.files.begin(), output.files.end());
  return files;
}

/// Which complete results a run that was broken off has left, and what to do; nothing where there are none.
std::string kept_text(const RunSummary& summary, const InputError& error) {
  std::string cut = error.what();
  for (const std::string& failure : summary.unwritten) cut += "\n" + failure;
  std::vector<std::string> kept;
  for (const char* name : {"trajectory.tum", "trajectory_final.tum", "states.csv", "map.ply", "metrics.json"}) {
    const std::filesystem::path file = std::filesystem::path(summary.run.folder) / name;
    if (std::filesystem::exists(file) && cut.find(file.string()) == std::string::npos) kept.emplace_back(name);
  }
  if (kept.empty()) return "";
  return fmt::format(
      "; {} holds complete, up to then: {}; correct the cause and run again, with --force to replace them",
      summary.run.folder, fmt::join(kept, ", "));
}

}  // namespace

Run::Run(RunContext& context, const std::vector<RunOutput>& outputs)
    : run_(context),
      odometry_(run_.source.calibration.rig, run_.source.calibration.imu, run_.mode, run_.config.odometry,
                {kInOrder, run_.options.live ? Inference::OwnThread : Inference::Synchronous}),
      truth_(read_truth(run_.source)) {
  if (run_.options.live && run_.source.seed)
    throw InputError::format("--live replays a recording; write one first: edged simulate --preset {}",
                             run_.info().name);
  for (const RunOutput& output : outputs)
    if (auto observer = output.make(run_)) observers_.push_back(std::move(observer));
  if (const InitialMap map = std::exchange(run_.products.get<InitialMap>(), {}); !map.bytes.empty()) {
    try {
      odometry_.load_map(map.bytes);
    } catch (const InputError& e) {
      throw InputError::format("{}: {}", map.file.string(), e.what());
    }
  }
  update_context();
  make_folder(outputs);
}

void Run::make_folder(const std::vector<RunOutput>& outputs) {
  const EarlierRun earlier = run_.options.force ? EarlierRun::Replace : EarlierRun::Keep;
  const std::string& archive = run_.options.archive;
  if (!archive.empty() && archive != kArchiveBeside)
    check_archive(run_.archive = archive, earlier);  // before the folder exists
  const std::filesystem::path wanted = run_folder_path(run_);
  run_.folder = make_run_folder(wanted, earlier, files_of(outputs));
  if (archive == kArchiveBeside) {
    try {
      check_archive(run_.archive = beside(run_.folder, ".zip"), earlier);
    } catch (const InputError&) {
      remove_new_run_folder(run_.folder);
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
  if (const auto clock = found_imu_clock(run_.options.source))
    spdlog::info(
        fmt::format("IMU clock: {} added to its stamps, {}", offset_text(*clock), offset_evidence(*clock->found)));
  if (!truth_.problem.empty())
    spdlog::warn(fmt::format("the ground truth cannot be used, so nothing is compared with it: {}", truth_.problem));
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
        odometry_, [&] { return next_measurement(reader); },
        [&](const Step& step) {
          observe(step, reader);
          return interrupt_signal() == 0;
        });
  } catch (const InputError& e) {
    throw InputError::format("{}{}", e.what(), kept_text(break_off(reader, e), e));
  } catch (const std::exception& e) {
    break_off(reader, e);
    throw;
  }
  return finish(reader, false);
}

RunSummary Run::break_off(RunReader& reader, const std::exception& error) {
  spdlog::info(fmt::format("broken off: {}", error.what()));  // main reports it
  return finish(reader, true);
}

std::optional<Measurement> Run::next_measurement(RunReader& reader) {
  std::optional<Measurement> measurement = reader.next();
  if (!measurement) return measurement;
  for (const auto& observer : observers_) observer->on_measurement(*measurement);
  run_.statistics.add_visual(*measurement, run_.used);
  return measurement;
}

void Run::observe(const Step& step, RunReader& reader) {
  run_.pace.processing_ms = 1e3 * odometry_.timings().find("process")->last_s();
  if (const auto latency_s = reader.note_result(step.t)) run_.pace.latency_ms = 1e3 * *latency_s;
  run_.statistics.add(step);
  run_.statistics.set_dropped(reader.dropped());
  update_context();
  for (auto next = observers_.begin(); next != observers_.end();) {
    const std::string stage = (*next)->stage();
    const auto timer = run_.timings.measure(stage);
    for (; next != observers_.end() && (*next)->stage() == stage; ++next) (*next)->on_step(step);
  }
}

void Run::update_context() {
  run_.rig = odometry_.rig();
  run_.awaiting_relocalization = odometry_.awaiting_relocalization();
}

RunSummary Run::finish(RunReader& reader, bool broken_off) {
  reader.stop();
  RunEnd end = summarize(reader, broken_off);
  std::vector<std::string> unwritten;
  // One that fails, on a full disk, costs no other.
  const auto attempt = [&unwritten](const auto& write) {
    try {
      write();
      return true;
    } catch (const InputError& e) {
      unwritten.emplace_back(e.what());
    } catch (const std::system_error& e) {
      unwritten.emplace_back(e.what());
    }
    return false;
  };
  for (const auto& observer : observers_) attempt([&] { observer->on_end(end); });
  if (!std::filesystem::exists(run_.folder / "report.html") && end.summary.verdict.trusted)
    end.summary.verdict.next = fmt::format("make room, then edged report {}", shell_word(run_.folder.string()));
  if (!run_.archive.empty() && !attempt([&] { zip_folder(run_.archive, run_.folder); }))
    end.summary.run.archive.clear();
  end.summary.unwritten = std::move(unwritten);
  return end.summary;
}

RunEnd Run::summarize(const RunReader& reader, bool broken_off) {
  update_context();
  run_.statistics.set_dropped(reader.dropped());
  RunEnd end;
  end.counters = odometry_.counters();
  end.covariances = calibration_covariances(odometry_);
  end.save_map = [this] { return odometry_.save_map(); };
  end.truth = truth_.truth;
  end.summary = begin_summary(run_);
  add_dropped(end.summary.repairs, end.counters);
  end.summary.live = reader.live_summary(end.counters);
  if (!truth_.problem.empty())
    end.summary.verdict.findings.push_back({Severity::Warning, "ground truth: cannot be used: " + truth_.problem,
                                            "correct it; edged eval TRUTH trajectory.tum compares later"});
  {
    const auto tell = [this](double share) {
      for (const auto& observer : observers_) observer->on_optimization(share);
    };
    const auto timer = run_.timings.measure("final_trajectory");
    tell(0.0);
    end.final_trajectory = odometry_.final_trajectory(tell);
  }
  for (const auto& observer : observers_) observer->on_summary(end);
  end.timings = odometry_.timings();
  compare(end);
  const Ending ending = broken_off                ? Ending::BrokenOff
                        : interrupt_signal() != 0 ? Ending::Interrupted
                                                  : Ending::Complete;
  judge_run(end.summary, run_.options.source, ending);
  end.summary.resources.peak_rss_mb = ResourceMeter::peak_rss_mb();
  return end;
}

void Run::compare(RunEnd& end) const {
  if (!end.truth) return;
  const OutputFrame frame(run_.estimated_rig(), end.truth->frame);
  const StatesTable states = read_states(run_.folder);
  CausalPoses poses = causal_poses(run_.folder, states, run_.frame.name(), frame);
  if (end.in_map_since) poses.begin_at(*end.in_map_since);
  if (poses.body.empty()) return;
  TruthComparison& result = end.summary.truth;
  result = compare_with_truth(poses, covariance_samples_of(states), frame, *end.truth);
  if (!result.evaluation) return;
  Trajectory final_poses = end.final_trajectory.poses;
  if (end.in_map_since) std::erase_if(final_poses, [&](const StampedPose& pose) { return pose.t < *end.in_map_since; });
  result.final_evaluation = evaluate(associate(end.truth->trajectory, frame(final_poses)), protocol("P3"));
}

}  // namespace edged
