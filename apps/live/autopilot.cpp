// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --mavlink: sends the state at each IMU sample of a live run to an autopilot.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <memory>
#include <mutex>

#include "edged/autopilot/mavlink_output.hpp"
#include "edged/core/check.hpp"
#include "edged/live/arrival_clock.hpp"
#include "edged/pipeline/localization/state_prediction.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

struct AutopilotOptions {
  std::string url;  ///< of the autopilot; "" without one
};

/// Predicts in the thread that plays the recording: the thread of the run is busy with packets for milliseconds, and
/// its newest_state() waits as long for the samples.
class AutopilotOutput : public RunObserver {
 public:
  explicit AutopilotOutput(RunContext& run)
      : run_(run), url_(run.options.outputs.get<AutopilotOptions>().url), output_(url_, run.config.autopilot) {}

  void on_due(const Measurement& measurement) override {
    const auto* sample = std::get_if<ImuSample>(&measurement);
    if (!sample) return;
    const Duration now = MavlinkOutput::unix_now();
    const std::lock_guard lock(mutex_);
    clock_.arrived(sample->t, now);
    prediction_.add(*sample);
    const std::optional<NavState> state = prediction_.newest();
    if (!state || state->t != sample->t) return;
    if (output_.send(*state, sample->gyro_B, clock_.at(state->t)))
      to_wire_.add(to_seconds(MavlinkOutput::unix_now() - now));
  }

  /// Corrects the prediction, with the reset counter of its step, or with the state before: never a state with the
  /// counter of another.
  void on_step(const Step& step) override {
    const std::lock_guard lock(mutex_);
    prediction_.correct(is_tracking(step.status) ? std::optional(step.state) : std::nullopt);
    output_.note(step);
  }

  void on_summary(RunEnd&) override {
    run_.timings.put("autopilot", to_wire_);
    const MavlinkCounters counters = output_.counters();
    const std::string text =
        fmt::format("{}: {} messages of odometry, {} heartbeats and {} answers to TIMESYNC sent, {} not accepted", url_,
                    counters.odometry, counters.heartbeats, counters.timesyncs, counters.dropped);
    spdlog::log(counters.dropped > 0 ? spdlog::level::warn : spdlog::level::info, text);
  }

 private:
  RunContext& run_;
  const std::string& url_;
  MavlinkOutput output_;

  std::mutex mutex_;  ///< guards all below
  ArrivalClock clock_;
  StatePrediction prediction_;
  StageTiming to_wire_;  ///< from the arrival of a sample until the line has its message
};

}  // namespace

RunOutput autopilot_output() {
  return {
      {},
      [](CLI::App& command, Board& options) {
        command.add_option(
            "--mavlink", options.get<AutopilotOptions>().url,
            "With --live: send the odometry to an autopilot as MAVLink: udp:HOST:PORT, udpin:HOST:PORT (listens) or "
            "serial:DEVICE:BAUD; how the IMU is mounted, rate and ids: options autopilot.*");
      },
      [](RunContext& run) -> std::unique_ptr<RunObserver> {
        if (run.options.outputs.get<AutopilotOptions>().url.empty()) return nullptr;
        if (!run.options.live)
          throw InputError(
              "--mavlink needs --live: an autopilot treats each pose as the current one, and a run that is faster or "
              "slower than its recording would give it old ones");
        return std::make_unique<AutopilotOutput>(run);
      }};
}

}  // namespace edged
