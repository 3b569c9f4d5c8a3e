// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "commands/ros2_options.hpp"
#include "common/interrupt.hpp"
#include "common/source.hpp"
#include "common/status_line.hpp"
#include "common/text.hpp"
#include "dds/player.hpp"
#include "edged/core/check.hpp"
#include "program/commands.hpp"

namespace edged {
namespace {

struct PlayOptions {
  SourceOptions source;
  Ros2Place place;
  bool ros2 = false;
  double rate = 1.0;
  bool best_effort = false;
  bool wait = false;
  bool loop = false;
  bool quiet = false;
};

void wait_for_subscribers(const ros2::Player& player, StatusLine& status) {
  constexpr auto kGrace = std::chrono::milliseconds(500);  // the other topics of the subscriber follow
  while (!player.has_subscriber() && interrupt_signal() == 0) {
    if (status.due()) status.show("waiting for a subscriber");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::this_thread::sleep_for(kGrace);
}

void print_counters(const ros2::PlayCounters& counters) {
  std::string text =
      fmt::format("sent {} in {}", quantity(counters.events, "event"), quantity(counters.messages, "message"));
  if (counters.dropped > 0)
    text += fmt::format("; {} dropped, as subscribers did not keep up: lower --rate",
                        quantity(counters.dropped, "message"));
  std::puts(text.c_str());
}

int run_play(const PlayOptions& options) {
  if (!options.ros2) throw InputError("say where to play to: --ros2");
  SourceOptions source = options.source;
  source.all_cameras = true;
  Recording recording = open_uncalibrated(source);
  catch_interrupts();
  ros2::Player player({discovery_of(options.place), names_of(options.place), options.rate, options.best_effort},
                      {{}, recording.dataset->info(), recording.calibration});
  StatusLine status(options.quiet);
  if (options.wait) wait_for_subscribers(player, status);
  const auto stop = [] { return interrupt_signal() != 0; };
  do {
    if (!recording.dataset) recording = open_uncalibrated(source);
    const ros2::PlayCounters counters = player.play(*recording.dataset, stop, [&](Timestamp t) {
      if (status.due())
        status.show(progress_text(t, recording.dataset->info(), "played"), share_done(t, recording.dataset->info()));
    });
    status.clear();
    if (counters.messages == 0 && !stop())
      throw InputError::format("{}: no measurement is in it, so there is nothing to play",
                               recording.dataset->info().name);
    recording.dataset.reset();
    print_counters(counters);
  } while (options.loop && !stop());
  return kExitOk;
}

}  // namespace

void add_play_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<PlayOptions>();
  CLI::App* play = app.add_subcommand("play", "Play a recording of any format as topics of ROS 2");
  add_source_options(*play, options->source);
  add_cameras_option(*play, options->source);
  play->add_flag("--ros2", options->ros2, "To ROS 2: the only choice so far");
  add_ros2_place(*play, options->place, "edged_play");
  play->add_option("--rate", options->rate, "Speed; 2 is twice as fast as recorded")->check(CLI::Range(0.01, 1000.0));
  play->add_flag("--best-effort", options->best_effort, "Offer best effort, as drivers do; lost messages stay lost");
  play->add_flag("--wait", options->wait, "Begin when the first subscriber has come");
  play->add_flag("--loop", options->loop, "Again and again; the clock jumps back");
  play->add_flag("--quiet", options->quiet, "No status line");
  play->footer(
      "Topics: events (EventPacket), image, imu, height (FluidPressure), velocity (TwistWithCovarianceStamped), "
      "/clock;\n"
      "of a further camera NAME: NAME/events, NAME/image. Stamps are those of the recording.\n"
      "Examples:\n"
      "  edged play flight.bag --ros2 --wait\n"
      "  edged play flight.aedat4 --ros2 --rate 2 -r events:=/event_camera/events");
  play->callback([options, &chosen] { chosen = [options] { return run_play(*options); }; });
}

}  // namespace edged
