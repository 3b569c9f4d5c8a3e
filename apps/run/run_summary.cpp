// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_summary.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/counted.hpp"
#include "common/files.hpp"
#include "common/json_text.hpp"
#include "common/status_line.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "inspect/survey.hpp"
#include "program.hpp"
#include "report/evaluation.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

double per(double amount, double of) { return of > 0.0 ? amount / of : 0.0; }

/// Below zero: the estimate is too large.
nlohmann::ordered_json scale_error(const std::optional<Evaluation>& e, double Evaluation::*scale) {
  return number_or_null(e ? std::optional(*e.*scale - 1.0) : std::nullopt);
}

std::string line(const char* name, const std::string& value, const std::string& note = "") {
  return note.empty() ? wrapped(fmt::format("  {:<20} {}", name, value), 23) + '\n'
                      : wrapped(fmt::format("  {:<20} {:<12} {}", name, value, note), 36) + '\n';
}

std::string consistency_line(const Consistency& c) {
  return line("within 3 sigma", fmt::format("{:.1f} %", 100.0 * c.position.within),
              fmt::format("of the positions, {:.1f} % of the rotations; {:.1f} s diverged silently",
                          100.0 * c.rotation.within, c.silent_s()));
}

nlohmann::ordered_json accuracy_json(const std::optional<Evaluation>& e) {
  const auto field = [&e](auto get) { return e ? number_or_null(get(*e)) : nlohmann::ordered_json(nullptr); };
  nlohmann::ordered_json json = {{"alignment", to_string(e ? e->protocol.alignment : AlignmentKind::SE3)},
                                 {"ate_rmse_m", field([](const Evaluation& v) { return v.ate_m.rmse; })},
                                 {"ate_mean_m", field([](const Evaluation& v) { return v.ate_m.mean; })},
                                 {"ate_max_m", field([](const Evaluation& v) { return v.ate_m.max; })},
                                 {"mpe_percent", field([](const Evaluation& v) { return v.mpe_percent; })},
                                 {"rotation_mean_deg", field([](const Evaluation& v) { return v.rotation_deg.mean; })},
                                 {"scale", field([](const Evaluation& v) { return v.scale; })}};
  for (std::size_t i = 0; i < kLocalWindows_s.size(); ++i) {
    json[fmt::format("local_error_{}s_m", kLocalWindows_s[i])] =
        field([i](const Evaluation& v) { return v.local.at(i).rmse_m; });
  }
  return json;
}

nlohmann::ordered_json live_json(const LiveSummary& live) {
  const QueuePeaks& peaks = live.peaks;
  return {{"latency_s",
           {{"p50", live.latency.quantile_s(0.50)},
            {"p95", live.latency.quantile_s(0.95)},
            {"p99", live.latency.quantile_s(0.99)},
            {"max", live.latency.max_s()}}},
          {"shed", {{"events", live.shed.events}, {"frames", live.shed.frames}, {"packets", live.shed_packets}}},
          {"queue_peak",
           {{"events", peaks.events},
            {"frames", peaks.frames},
            {"imu_samples", peaks.imu},
            {"bytes", peaks.bytes},
            {"age_s", peaks.age_s}}}};
}

nlohmann::ordered_json dense_json(const DenseSummary& dense) {
  return {{"keyframes", dense.keyframes},
          {"without_parallax", dense.without_parallax},
          {"dropped", dense.dropped},
          {"edge_pixels", dense.edges},
          {"with_depth", dense.with_depth}};
}

std::string dense_line(const DenseSummary& dense) {
  const double share = per(static_cast<double>(dense.with_depth), static_cast<double>(dense.edges));
  const std::string dropped = dense.dropped > 0 ? fmt::format("; {} left out: too slow", dense.dropped) : "";
  return line("dense depth", counted(dense.keyframes, "keyframe"),
              fmt::format("{:.0f} % of their edge pixels; {} without parallax{}", 100.0 * share, dense.without_parallax,
                          dropped));
}

std::string live_table(const LiveSummary& live) {
  const StageTiming& latency = live.latency;
  const bool shed = live.shed != ShedCounters{} || live.shed_packets > 0;
  return line("latency", fmt::format("{:.1f} ms", 1e3 * latency.quantile_s(0.50)),
              fmt::format("median; 95 % {:.1f} ms, 99 % {:.1f} ms, worst {:.1f} ms", 1e3 * latency.quantile_s(0.95),
                          1e3 * latency.quantile_s(0.99), 1e3 * latency.max_s())) +
         line("left out", shed ? counted(live.shed.events, "event") : "nothing",
              shed ? fmt::format("{}, {}: too slow", counted(live.shed.frames, "frame"),
                                 counted(live.shed_packets, "packet"))
                   : "");
}

std::string calibration_line(const CalibrationFound& c) {
  const auto sigma = [](const std::optional<double>& value) { return value ? fmt::format(" +- {:.2f}", *value) : ""; };
  return line("camera calibration", fmt::format("{:.2f}{} deg", c.rotation_deg, sigma(c.rotation_sigma_deg)),
              fmt::format("of rotation off, time offset {:.2f}{} ms{} (given {:.2f}): {}", c.time_offset_ms,
                          sigma(c.time_sigma_ms), c.events ? ", with the latency of its pixels" : "", c.given_offset_ms,
                          c.camera));
}

std::string verdict_text(const RunSummary& s) {
  const Verdict& v = s.verdict;
  std::string text;
  if (!v.findings.empty()) text += to_text(v.findings);
  for (const std::string& failure : s.unwritten) text += line("not written", failure);
  return text + line("verdict", v.text) + line("next", v.next);
}

class SummaryFiles : public RunObserver {
 public:
  explicit SummaryFiles(const RunContext& run) : run_(run) {}
  void on_end(const RunEnd& end) override {
    write_file(run_.folder / "timing.json", timing_json(run_.odometry.timings(), run_.timings));
    write_file(run_.folder / "metrics.json", json_text(to_json(end.summary)) + "\n");
  }

 private:
  const RunContext& run_;
};

}  // namespace

void evaluate_run(RunSummary& summary, const Trajectory& body, const std::vector<StateCovarianceSample>& samples,
                  const Rig& rig, const GroundTruth& truth) {
  try {
    const OutputFrame frame(rig, truth.frame);
    const Association association = associate(truth.trajectory, frame(body));
    summary.evaluation = evaluate(association, protocol("P3"));
    Trajectory true_body;
    for (const StampedPose& pose : truth.trajectory) true_body.push_back(frame.to_body(pose));
    summary.consistency = check_consistency(true_body, samples);
    summary.truth_offset = fit_time_offset(truth.trajectory, frame(body));
    for (const char* name : {"P1", "P2", "P3", "P4"}) {
      try {
        summary.mpe_percent[name] = evaluate(association, protocol(name), {}, {}).mpe_percent;
      } catch (const InputError& e) {
        spdlog::info(fmt::format("protocol {} does not apply: {}", name, e.what()));
      }
    }
  } catch (const InputError& e) {
    spdlog::warn(fmt::format("no comparison with the ground truth: {}", e.what()));
  }
}

void evaluate_final(RunSummary& summary, const Trajectory& body, const Rig& rig, const GroundTruth& truth) {
  summary.final_evaluation = evaluate(associate(truth.trajectory, OutputFrame(rig, truth.frame)(body)), protocol("P3"));
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
      {"measurements with absurd stamps dropped", intake.absurd_stamps},
      {"measurements with stamps far ahead dropped", intake.far_ahead},
      {"clocks set back: restarted", intake.clocks_set_back},
      {"packets before the first IMU sample dropped", packets.packets_before_imu},
      {"packets after the last IMU sample dropped", packets.packets_after_imu > 1 ? packets.packets_after_imu : 0},
      {"packets dropped during gaps of the IMU", packets.packets_overflow},
      {"late events dropped", packets.events_late},
      {"events of flickering lamps left out", packets.events_flicker},
      {"late frames dropped", packets.frames_late},
      {"times of 5 s without a frame", packets.frames_missing},
      {"late IMU samples dropped", packets.imu_late},
      {"IMU samples dropped that are no numbers", packets.imu_not_finite},
  };
  for (const auto& [kind, count] : dropped) {
    if (count > 0) repairs[kind] += count;
  }
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    const std::size_t late = packets.external_late[i];
    if (late > 0) repairs[fmt::format("late {} samples dropped", external_sensors()[i].name)] += late;
  }
}

nlohmann::ordered_json to_json(const RunSummary& s) {
  const double span = s.statistics.visual_span_s();
  nlohmann::ordered_json json = {{"recording", s.recording},
                                 {"format", s.format},
                                 {"mode", s.mode},
                                 {"folder", s.folder},
                                 {"output_frame", s.frame},
                                 {"version", kVersion},
                                 {"seed", s.seed ? nlohmann::ordered_json(*s.seed) : nlohmann::ordered_json(nullptr)},
                                 {"status", s.status},
                                 {"verdict", s.verdict.text},
                                 {"trusted", s.verdict.trusted},
                                 {"findings", to_json(s.verdict.findings)},
                                 {"waiting_for", s.verdict.waiting_for},
                                 {"next", s.verdict.next}};
  json.update(accuracy_json(s.evaluation));
  json["final_not_causal"] = accuracy_json(s.final_evaluation);
  json.update({{"poses", s.poses},
               {"keyframes", s.statistics.keyframes()},
               {"packets", s.statistics.packets()},
               {"coverage", s.statistics.coverage()},
               {"first_good_s", number_or_null(s.statistics.first_good_s())},
               {"scale_error_at_first_good", scale_error(s.evaluation, &Evaluation::first_scale)},
               {"scale_error_10s_later", scale_error(s.evaluation, &Evaluation::later_scale)},
               {"loops_closed", s.statistics.loops_closed()},
               {"times_lost", s.statistics.times_lost()},
               {"duration_s", span},
               {"wall_s", s.wall_s},
               {"real_time_factor", per(span, s.wall_s)},
               {"cpu_s_per_s", per(s.cpu_s, span)},
               {"peak_rss_mb", s.peak_rss_mb}});
  for (const TrackingStatus status :
       {TrackingStatus::Initializing, TrackingStatus::Good, TrackingStatus::Degraded, TrackingStatus::Lost}) {
    json["seconds_in"][to_string(status)] = s.statistics.time_in_s(status);
  }
  const auto& ln_s = s.statistics.ln_depth_scale();
  json["depth_scale"] = number_or_null(ln_s ? std::optional(std::exp(ln_s->value)) : std::nullopt);
  json["depth_scale_sigma_ln"] = number_or_null(ln_s ? std::optional(ln_s->sigma) : std::nullopt);
  if (s.live) json["live"] = live_json(*s.live);
  if (!s.archive.empty()) json["archive"] = s.archive;
  if (!s.unwritten.empty()) json["unwritten"] = s.unwritten;
  if (s.map)
    json["map"] = {{"loaded", s.map->loaded},
                   {"localize_only", s.map->localize_only},
                   {"found_s", number_or_null(s.map->found_s)},
                   {"relocalized", s.map->relocalized},
                   {"saved", s.map->saved}};
  if (s.dense) json["dense"] = dense_json(*s.dense);
  json["calibration"] = nlohmann::ordered_json::array();
  for (const CalibrationFound& c : s.calibration) json["calibration"].push_back(to_json(c));
  json["mpe_percent_by_protocol"] = s.mpe_percent;
  json["consistency"] = s.consistency ? to_json(*s.consistency) : nlohmann::ordered_json(nullptr);
  json["ground_truth_time_offset"] = s.truth_offset ? to_json(*s.truth_offset) : nlohmann::ordered_json(nullptr);
  for (const auto& [sensor, e] : s.external)
    json["external"][sensor] = {{"samples", e.samples}, {"used", e.used}, {"rejected", e.rejected}, {"late", e.late}};
  json["repairs"] = s.repairs;
  json["evaluation"] = s.evaluation ? to_json(*s.evaluation) : nlohmann::ordered_json(nullptr);
  return json;
}

std::string timing_json(const StageTimings& pipeline, const StageTimings& program) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
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
  return nlohmann::ordered_json{{"stages", stages}}.dump(2) + "\n";
}

std::string to_table(const RunSummary& s) {
  const double span = s.statistics.visual_span_s();
  std::string table = fmt::format("{}, {}, {:.1f} s -> {}\n", s.recording, s.mode, span, s.folder);
  const std::size_t losses = s.statistics.times_lost();
  table += line("status", losses > 0 ? s.status + ", lost " + counted(losses, "time") : s.status);
  if (s.evaluation) {
    const Evaluation& e = *s.evaluation;
    table += line("ATE RMSE", error_text(e.ate_m.rmse),
                  fmt::format("{} alignment, {}, {:.2f} m path", to_string(e.protocol.alignment),
                              counted(e.pairs, "pose"), e.path_length_m));
    table += line("local error", local_error_text(e.local));
    if (s.final_evaluation) {
      const std::string local = local_error_text(s.final_evaluation->local);
      table += line("final, not causal", error_text(s.final_evaluation->ate_m.rmse),
                    "ATE of the final trajectory" + (local.starts_with('-') ? "" : "; local error " + local));
    }
    if (std::isnan(e.mpe_percent))
      table += line("mean position error", "-", fmt::format("the path is shorter than {} m", kShortestPath_m));
    else
      table += line("mean position error", fmt::format("{:.3f} %", e.mpe_percent), "of the path");
    const std::string start = std::isnan(e.start_scale) ? "" : fmt::format("; {:.4f} in the first 5 s", e.start_scale);
    if (std::isnan(e.scale))
      table += line("scale", "-", "too little motion");
    else
      table += line("scale", fmt::format("{:.4f}", e.scale), "1 is perfect" + start);
    if (s.consistency && s.consistency->poses > 0) table += consistency_line(*s.consistency);
  } else {
    table += line("ATE RMSE", "-", "no ground truth to compare with");
  }
  for (const CalibrationFound& c : s.calibration) table += calibration_line(c);
  for (const auto& [sensor, e] : s.external)
    table += line(sensor.c_str(), fmt::format("{} used", e.used),
                  fmt::format("of {}; {} rejected, {} late", counted(e.samples, "sample"), e.rejected, e.late));
  const std::size_t loops = s.statistics.loops_closed();
  table += line("poses / keyframes", fmt::format("{} / {}", s.poses, s.statistics.keyframes()),
                loops > 0 ? counted(loops, "loop") + " closed" : "");
  table += line(
      "coverage", fmt::format("{:.1f} %", 100.0 * s.statistics.coverage()),
      s.statistics.first_good_s() ? fmt::format("first good pose after {:.2f} s", *s.statistics.first_good_s()) : "");
  table += line("real-time factor", fmt::format("{:.2f}", per(span, s.wall_s)),
                fmt::format("{:.2f} cpu s per s, peak {:.0f} MB", per(s.cpu_s, span), s.peak_rss_mb));
  if (const auto& ln_s = s.statistics.ln_depth_scale()) {
    table += line("depth source", fmt::format("x {:.3f}", std::exp(ln_s->value)),
                  fmt::format("its depths over the landmarks', +- {:.0f} %", 100.0 * ln_s->sigma));
  }
  if (s.map && !s.map->loaded.empty()) {
    table += line("map", s.map->found_s ? fmt::format("{:.1f} s", *s.map->found_s) : "not found",
                  s.map->found_s         ? "from the start until found in " + s.map->loaded
                  : s.map->localize_only ? "again: there are no poses"
                                         : "again: poses are in a frame of their own");
  }
  if (s.map && !s.map->saved.empty()) table += line("map kept", s.map->saved);
  if (s.dense) table += dense_line(*s.dense);
  if (!s.archive.empty()) table += line("archive", s.archive);
  if (s.live) table += live_table(*s.live);
  for (const auto& [kind, count] : s.repairs) table += line("repaired", fmt::format("{} x", count), kind);
  return table + verdict_text(s);
}

std::unique_ptr<RunObserver> observe_summary(RunContext& run) { return std::make_unique<SummaryFiles>(run); }

}  // namespace edged
