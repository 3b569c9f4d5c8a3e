// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// run.log and the status line: the messages of a run.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "common/status_line.hpp"
#include "common/step_numbers.hpp"
#include "common/text.hpp"
#include "edged/core/angles.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

class RunStatusLine : public RunObserver {
 public:
  explicit RunStatusLine(const RunContext& run) : run_(run), line_(run.options.quiet) {}
  void on_step(const Step& step) override {
    if (line_.due()) line_.show(text_of(step), share_done(step.t, run_.info()));
  }
  void on_optimization(double share) override {
    constexpr double kLong_s = 5.0;  // of a run: the optimization takes seconds a minute of recording
    if (run_.meter.wall_s() > kLong_s)
      line_.show(fmt::format("joint optimization of {}, {:.0f} %", quantity(run_.statistics.keyframes(), "keyframe"),
                             100.0 * share));
  }
  void on_summary(RunEnd&) override { line_.clear(); }

 private:
  std::string text_of(const Step& step) const {
    const DatasetInfo& info = run_.info();
    const double done_s = run_.statistics.visual_span_s();
    std::string text = info.begin && info.end ? fmt::format("{:.1f} / {:.1f} s", to_seconds(step.t - *info.begin),
                                                            to_seconds(*info.end - *info.begin))
                                              : fmt::format("{:.1f} s", done_s);
    text += fmt::format("  {:.1f}x", done_s / run_.meter.wall_s());
    if (run_.mode != Mode::Frames) {
      const ModalityNumbers events = modality_numbers(step, Modality::Events);
      text += fmt::format("  {}ev/s  event tracks {}", si_number(events.event_rate_hz), events.tracks);
    }
    if (run_.mode != Mode::Events)
      text += fmt::format("  frame tracks {}", modality_numbers(step, Modality::Frames).tracks);
    if (const auto overload = run_.statistics.overload(); overload.share >= kToldOverload) text += "  " + overload.text;
    text += "  " + to_string(step.status);
    if (!step.waiting_for.empty()) text += ", waits for " + step.waiting_for;
    return text;
  }

  const RunContext& run_;
  StatusLine line_;
};

class RunLog : public RunObserver {
 public:
  explicit RunLog(const RunContext&) {}
  void on_step(const Step& step) override {
    const double t_s = to_seconds(step.t);
    if (!step.started.empty()) spdlog::info(fmt::format("{:.3f} s: started {}", t_s, step.started));
    if (step.relocalized) spdlog::info(fmt::format("{:.3f} s: relocalized in the map", t_s));
    if (step.loop_closure)
      spdlog::info(
          fmt::format("{:.3f} s: loop closed, at the place of {:.3f} s; the pose was {:.3f} m and {:.2f} deg off", t_s,
                      to_seconds(step.loop_closure->keyframe), step.loop_closure->position_m,
                      step.loop_closure->rotation_rad / kDegree));
    if (std::exchange(status_, step.status) == step.status) return;
    if (step.status == TrackingStatus::Lost)
      spdlog::warn(fmt::format("lost at {:.3f} s: {}; starting again", t_s, step.lost_because));
    const std::string why = step.degraded_because.empty() ? "" : ", " + step.degraded_because;
    spdlog::info(fmt::format("{:.3f} s: {}{}", t_s, to_string(step.status), why));
  }

  void on_end(const RunEnd& end) override {
    const RunSummary& summary = end.summary;
    for (const auto& [kind, count] : summary.repairs) spdlog::info(fmt::format("repaired: {} x {}", count, kind));
    for (const Finding& finding : summary.verdict.findings)
      spdlog::info(fmt::format("found: {}: {}", finding.text, finding.remedy));
    spdlog::info(fmt::format("verdict: {}", summary.verdict.text));
    spdlog::info(fmt::format("status {}, {}, {}", summary.verdict.status, quantity(summary.statistics.poses(), "pose"),
                             quantity(summary.statistics.keyframes(), "keyframe")));
  }

 private:
  TrackingStatus status_ = TrackingStatus::Initializing;
};

}  // namespace

RunOutput status_line_output() { return always<RunStatusLine>(); }
RunOutput log_output() { return always<RunLog>(); }

}  // namespace edged
