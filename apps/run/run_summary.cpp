// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_summary.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cmath>

#include "common/cli.hpp"
#include "common/findings.hpp"
#include "common/json_text.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "edged/imu/imu_gate.hpp"
#include "report/evaluation.hpp"

namespace edged {
namespace {

using Json = nlohmann::ordered_json;

double per(double amount, double of) { return of > 0.0 ? amount / of : 0.0; }

template <typename T>
Json json_or_null(const std::optional<T>& value) {
  return value ? to_json(*value) : Json(nullptr);
}

void add_identity(Figures& out, const RunSummary& s) {
  const RunIdentity& run = s.run;
  const Verdict& verdict = s.verdict;
  out.json = {{"recording", run.recording},
              {"format", run.format},
              {"mode", run.mode},
              {"folder", run.folder},
              {"output_frame", run.frame},
              {"version", kVersion},
              {"seed", value_or_null(run.seed)},
              {"status", verdict.status},
              {"verdict", verdict.text},
              {"trusted", verdict.trusted},
              {"findings", to_json(verdict.findings)},
              {"waiting_for", verdict.waiting_for},
              {"next", verdict.next}};
  if (!run.archive.empty()) out.json["archive"] = run.archive;
  out.table =
      fmt::format("{}, {}, {:.1f} s -> {}\n", run.recording, run.mode, s.statistics.visual_span_s(), run.folder);
  const std::size_t losses = s.statistics.times_lost();
  out.line("status", verdict.status + (losses > 0 ? ", lost " + quantity(losses, "time") : ""));
}

Json accuracy_json(const std::optional<Evaluation>& evaluation) {
  const Evaluation e = evaluation.value_or(Evaluation());
  const auto known = [&evaluation](double x) { return number_or_null(evaluation ? std::optional(x) : std::nullopt); };
  Json json = {{"alignment", to_string(evaluation ? e.protocol.alignment : AlignmentKind::SE3)},
               {"ate_rmse_m", known(e.ate_m.rmse)},
               {"ate_mean_m", known(e.ate_m.mean)},
               {"ate_max_m", known(e.ate_m.max)},
               {"mpe_percent", known(e.mpe_percent)},
               {"rotation_mean_deg", known(e.rotation_deg.mean)},
               {"scale", known(e.scale)}};
  for (std::size_t i = 0; i < kLocalWindows_s.size(); ++i)
    json[fmt::format("local_error_{}s_m", kLocalWindows_s[i])] = known(evaluation ? e.local.at(i).rmse_m : 0.0);
  return json;
}

void add_accuracy_lines(Figures& out, const TruthComparison& truth) {
  if (!truth.evaluation) return out.line("ATE RMSE", "-", "no ground truth to compare with");
  const Evaluation& e = *truth.evaluation;
  out.line("ATE RMSE", error_text(e.ate_m.rmse),
           fmt::format("{} alignment, {}, {:.2f} m path", to_string(e.protocol.alignment), quantity(e.pairs, "pose"),
                       e.path_length_m));
  out.line("local error", local_error_text(e.local));
  if (truth.final_evaluation) {
    const std::string local = local_error_text(truth.final_evaluation->local);
    out.line("final, not causal", error_text(truth.final_evaluation->ate_m.rmse),
             "ATE of the final trajectory" + (local.starts_with('-') ? "" : "; local error " + local));
  }
  if (std::isnan(e.mpe_percent))
    out.line("mean position error", "-", fmt::format("the path is shorter than {} m", kShortestPath_m));
  else
    out.line("mean position error", fmt::format("{:.3f} %", e.mpe_percent), "of the path");
  const std::string start = std::isnan(e.start_scale) ? "" : fmt::format("; {:.4f} in the first 5 s", e.start_scale);
  if (std::isnan(e.scale))
    out.line("scale", "-", "too little motion");
  else
    out.line("scale", fmt::format("{:.4f}", e.scale), "1 is perfect" + start);
  if (const auto& c = truth.consistency; c && c->poses > 0)
    out.line("within 3 sigma", fmt::format("{:.1f} %", 100.0 * c->position.within),
             fmt::format("of the positions, {:.1f} % of the rotations; {:.1f} s diverged silently",
                         100.0 * c->rotation.within, c->silent_s()));
}

void add_accuracy(Figures& out, const TruthComparison& truth) {
  // Below zero: the estimate is too large.
  const auto scale_error = [&truth](double Evaluation::*scale) {
    return number_or_null(truth.evaluation ? std::optional(*truth.evaluation.*scale - 1.0) : std::nullopt);
  };
  out.json.update(accuracy_json(truth.evaluation));
  out.json.update({{"final_not_causal", accuracy_json(truth.final_evaluation)},
                   {"scale_error_at_first_good", scale_error(&Evaluation::first_scale)},
                   {"scale_error_10s_later", scale_error(&Evaluation::later_scale)},
                   {"mpe_percent_by_protocol", truth.mpe_percent},
                   {"consistency", json_or_null(truth.consistency)},
                   {"ground_truth_time_offset", json_or_null(truth.offset)},
                   {"evaluation", json_or_null(truth.evaluation)}});
  add_accuracy_lines(out, truth);
}

void add_calibration(Figures& out, const std::vector<CalibrationFound>& calibration) {
  const auto sigma = [](const std::optional<double>& value) { return value ? fmt::format(" +- {:.2f}", *value) : ""; };
  out.json["calibration"] = Json::array();
  for (const CalibrationFound& c : calibration) {
    out.json["calibration"].push_back(to_json(c));
    out.line("camera calibration",
             fmt::format("{:.2f}{} deg of rotation off, time offset {:.2f}{} ms{} (given {:.2f}): {}", c.rotation_deg,
                         sigma(c.rotation_sigma_deg), c.time_offset_ms, sigma(c.time_sigma_ms),
                         c.events ? ", with the latency of its pixels" : "", c.given_offset_ms, c.camera));
  }
}

/// What was done to the stamps of the IMU.
void add_imu_clock(Figures& out, const ChosenImuClock& chosen) {
  out.json["imu_clock"] = to_json(chosen);
  out.line("IMU clock", offset_text(chosen), "added to its stamps, " + offset_evidence(*chosen.found));
}

void add_progress(Figures& out, const RunStatistics& s) {
  out.json.update({{"poses", s.poses()},
                   {"keyframes", s.keyframes()},
                   {"packets", s.packets()},
                   {"coverage", s.coverage()},
                   {"first_good_s", number_or_null(s.first_good_s())},
                   {"scale_sigma", number_or_null(s.scale_sigma())},
                   {"loops_closed", s.loops_closed()},
                   {"times_lost", s.times_lost()},
                   {"duration_s", s.visual_span_s()}});
  for (const TrackingStatus status :
       {TrackingStatus::Initializing, TrackingStatus::Good, TrackingStatus::Degraded, TrackingStatus::Lost})
    out.json["seconds_in"][to_string(status)] = s.time_in_s(status);
  out.line("poses / keyframes", fmt::format("{} / {}", s.poses(), s.keyframes()),
           s.loops_closed() > 0 ? quantity(s.loops_closed(), "loop") + " closed" : "");
  out.line("coverage", fmt::format("{:.1f} %", 100.0 * s.coverage()),
           s.first_good_s() ? fmt::format("first good pose after {:.2f} s", *s.first_good_s()) : "");
}

void add_resources(Figures& out, const RunResources& used, double span_s) {
  out.json.update({{"wall_s", used.wall_s},
                   {"real_time_factor", per(span_s, used.wall_s)},
                   {"cpu_s_per_s", per(used.cpu_s, span_s)},
                   {"peak_rss_mb", used.peak_rss_mb}});
  out.line("real-time factor", fmt::format("{:.2f}", per(span_s, used.wall_s)),
           fmt::format("{:.2f} cpu s per s, peak {:.0f} MB", per(used.cpu_s, span_s), used.peak_rss_mb));
}

void add_depth_scale(Figures& out, const std::optional<LogScale>& ln_s) {
  const double scale = ln_s ? std::exp(ln_s->value) : 1.0;
  out.json["depth_scale"] = ln_s ? number_or_null(scale) : Json(nullptr);
  out.json["depth_scale_sigma_ln"] = ln_s ? number_or_null(ln_s->sigma) : Json(nullptr);
  if (ln_s)
    out.line("depth source", fmt::format("x {:.3f}", scale),
             fmt::format("its depths over the landmarks', +- {:.0f} %", 100.0 * ln_s->sigma));
}

Json live_json(const LiveSummary& live) {
  const QueuePeaks& peaks = live.peaks;
  return {{"latency_s",
           {{"p50", live.latency.quantile_s(0.50)},
            {"p95", live.latency.quantile_s(0.95)},
            {"p99", live.latency.quantile_s(0.99)},
            {"max", live.latency.max_s()}}},
          {"shed",
           {{"events", live.dropped.events},
            {"unread", live.dropped.unread},
            {"frames", live.dropped.frames},
            {"packets", live.dropped_packets}}},
          {"queue_peak",
           {{"events", peaks.events},
            {"frames", peaks.frames},
            {"imu_samples", peaks.imu},
            {"bytes", peaks.bytes},
            {"age_s", peaks.age_s}}}};
}

void add_live(Figures& out, const LiveSummary& live) {
  const StageTiming& latency = live.latency;
  out.json["live"] = live_json(live);
  out.line("latency", fmt::format("{:.1f} ms", 1e3 * latency.quantile_s(0.50)),
           fmt::format("median; 95 % {:.1f} ms, 99 % {:.1f} ms, worst {:.1f} ms", 1e3 * latency.quantile_s(0.95),
                       1e3 * latency.quantile_s(0.99), 1e3 * latency.max_s()));
  if (live.dropped == DropCounters{} && live.dropped_packets == 0) return out.line("left out", "nothing");
  out.line("left out", fmt::format("{}, {}, {}: too slow", quantity(live.dropped.events, "event"),
                                   quantity(live.dropped.frames, "frame"), quantity(live.dropped_packets, "packet")));
}

/// Repairs, what could not be written, and the verdict: the end of the table.
void add_end(Figures& out, const RunSummary& s) {
  out.json["repairs"] = s.repairs;
  if (!s.unwritten.empty()) out.json["unwritten"] = s.unwritten;
  for (const auto& [kind, count] : s.repairs) out.line("repaired", fmt::format("{} x", count), kind);
  if (!s.verdict.findings.empty()) out.table += to_text(s.verdict.findings);
  for (const std::string& failure : s.unwritten) out.line("not written", failure);
  out.line("verdict", s.verdict.text);
  out.line("next", s.verdict.next);
}

Figures figures_of(const RunSummary& s) {
  Figures out;
  add_identity(out, s);
  add_accuracy(out, s.truth);
  add_calibration(out, s.calibration);
  if (s.imu_clock) add_imu_clock(out, *s.imu_clock);
  add_progress(out, s.statistics);
  add_resources(out, s.resources, s.statistics.visual_span_s());
  add_depth_scale(out, s.statistics.ln_depth_scale());
  out.json.update(s.outputs.json);
  out.table += s.outputs.table;
  if (!s.run.archive.empty()) out.line("archive", s.run.archive);
  if (s.live) add_live(out, *s.live);
  add_end(out, s);
  return out;
}

}  // namespace

void Figures::line(const std::string& name, const std::string& value, const std::string& note) {
  table += note.empty() ? wrapped(fmt::format("  {:<20} {}", name, value), 23)
                        : wrapped(fmt::format("  {:<20} {:<11}  {}", name, value, note), 36);
  table += '\n';
}

TruthComparison compare_with_truth(const CausalPoses& poses, const std::vector<StateCovarianceSample>& samples,
                                   const OutputFrame& frame, const GroundTruth& truth) {
  TruthComparison result;
  try {
    const Association association = associate(truth.trajectory, poses.shown);
    result.evaluation = evaluate(association, protocol("P3"));
    Trajectory true_body;
    for (const StampedPose& pose : truth.trajectory) true_body.push_back(frame.to_body(pose));
    result.consistency = check_consistency(true_body, samples);
    result.offset = fit_time_offset(truth.trajectory, frame(poses.body));
    for (const char* name : {"P1", "P2", "P3", "P4"}) {
      try {
        result.mpe_percent[name] = evaluate(association, protocol(name), {}, {}).mpe_percent;
      } catch (const InputError& e) {
        spdlog::info(fmt::format("protocol {} does not apply: {}", name, e.what()));
      }
    }
  } catch (const InputError& e) {
    spdlog::warn(fmt::format("no comparison with the ground truth: {}", e.what()));
  }
  return result;
}

void add_dropped(std::map<std::string, std::size_t>& repairs, const OdometryCounters& counters) {
  const IntakeCounters& intake = counters.intake;
  const PacketizerCounters& packets = counters.packets;
  // One packet after the last IMU sample is how a recording, or a piece of it, ends.
  const std::pair<const char*, std::size_t> dropped[] = {
      {"measurements of cameras that the calibration does not have dropped", intake.unknown_camera},
      {"measurements dropped as the queue was full", intake.no_room},
      {"height or velocity samples dropped as impossible", intake.external_unfit},
      {"events outside the calibration's image dropped", intake.events_outside},
      {"frames of another size than the calibration's dropped", intake.frames_unfit},
      {"measurements with impossible stamps dropped", intake.absurd_stamps},
      {"measurements with stamps far ahead dropped", intake.far_ahead},
      {"clocks set back: restarted", intake.clocks_set_back},
      {"packets before the first IMU sample dropped", packets.packets_before_imu},
      {"packets after the last IMU sample dropped", packets.packets_after_imu > 1 ? packets.packets_after_imu : 0},
      {"packets dropped during gaps of the IMU", packets.packets_overflow},
      {"late events dropped", packets.events_late},
      {"events of bursts beyond any sensor's rate dropped", packets.events_surplus},
      {"events of flickering lamps left out", packets.events_flicker},
      {"late frames dropped", packets.frames_late},
      {"times of 5 s without a frame", packets.frames_missing},
  };
  for (const auto& [kind, count] : dropped) {
    if (count > 0) repairs[kind] += count;
  }
  for (std::size_t i = 0; i < kImuFaults; ++i)
    if (packets.imu[i] > 0) repairs[fmt::format("IMU samples {}", imu_fault_infos()[i].text)] += packets.imu[i];
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    const std::size_t late = packets.external_late[i];
    if (late > 0) repairs[fmt::format("late {} samples dropped", external_sensors()[i].name)] += late;
  }
}

nlohmann::ordered_json to_json(const RunSummary& summary) { return figures_of(summary).json; }

std::string to_table(const RunSummary& summary) { return figures_of(summary).table; }

std::string timing_json(const StageTimings& pipeline, const StageTimings& program) {
  Json stages = Json::array();
  for (const StageTimings* timings : {&program, &pipeline}) {
    for (const auto& [name, timing] : timings->all()) {
      stages.push_back({{"stage", name},
                        {"count", timing.count()},
                        {"mean_ms", 1e3 * timing.mean_s()},
                        {"p50_ms", 1e3 * timing.quantile_s(0.50)},
                        {"p95_ms", 1e3 * timing.quantile_s(0.95)},
                        {"p99_ms", 1e3 * timing.quantile_s(0.99)},
                        {"max_ms", 1e3 * timing.max_s()},
                        {"total_s", timing.total_s()}});
      if (timing.cpu_s()) stages.back()["cpu_s"] = *timing.cpu_s();
    }
  }
  return Json{{"stages", stages}}.dump(2) + "\n";
}

}  // namespace edged
