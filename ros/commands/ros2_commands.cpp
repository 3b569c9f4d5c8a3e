// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The commands of the program `edged` for ROS 2: `edged ros2` and `edged play`.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "commands/ros_arguments.hpp"
#include "common/command.hpp"
#include "common/config_source.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/source.hpp"
#include "common/status_line.hpp"
#include "common/text.hpp"
#include "dds/player.hpp"
#include "dds/ros2_transport.hpp"
#include "edged/core/check.hpp"
#include "node/node.hpp"
#include "program/commands.hpp"

namespace edged {
namespace {

/// Options that say where in the graph of ROS 2 the program is.
struct Ros2Place {
  std::optional<std::uint32_t> domain;  ///< instead of ROS_DOMAIN_ID
  std::string name_space = "/", node;
  std::vector<std::string> remappings;
};

/// Adds --domain, --namespace, --node and -r, --remap. node: the default name.
void add_ros2_place(CLI::App& command, Ros2Place& place, const std::string& node) {
  place.node = node;
  command.add_option("--domain", place.domain, "DDS domain, instead of ROS_DOMAIN_ID")->check(CLI::Range(0, 232));
  command.add_option("--namespace", place.name_space, "Namespace of the topics [/]");
  command.add_option("--node", place.node, "Name of the node [" + node + "]");
  command
      .add_option("-r,--remap", place.remappings,
                  "Another topic, as from:=to, e.g. events:=/event_camera/events; may be repeated")
      ->allow_extra_args(false);
}

/// From the environment, and the domain of the command line.
ros2::Discovery discovery_of(const Ros2Place& place) {
  ros2::Discovery discovery = ros2::discovery_of();
  if (place.domain) discovery.domain = *place.domain;
  return discovery;
}

ros2::Names names_of(const Ros2Place& place) { return {place.name_space, place.node, place.remappings}; }

/// Options of the odometry have the keys that they have in `edged run`.
struct Ros2Config : node::NodeConfig {
  bool reliable = false;
  bool use_sim_time = false;
  QueueConfig live;  ///< used by `edged run` alone, whose files are to load here

  void visit(ConfigFields& fields) {
    visit_node(fields);
    fields.add(
        "reliable", reliable,
        {"", 0, 0, "ask for reliable sensor topics; publishers that are best effort then do not reach the node"});
    fields.add("use_sim_time", use_sim_time, {"", 0, 0, "time of /diagnostics and /tf_static from /clock"});
    options.visit(fields);
    fields.group("live", live);
  }
};

struct Ros2Options {
  std::string rig, mode, imu_time_offset, distribution;
  ConfigSource config;
  Ros2Place place;
  RosArguments ros;
  bool use_sim_time = false;
  bool print_config = false;
  bool quiet = false;
};

Ros2Config config_of(const Ros2Options& options) {
  Ros2Config config;
  ConfigFields fields = ConfigFields::of(config);
  if (!options.config.file.empty()) fields.load(options.config.file);
  set_parameters(fields, options.ros, names_of(options.place).full_node_name());
  for (const std::string& assignment : options.config.assignments) fields.set(assignment);
  if (!options.rig.empty()) fields.set("rig", options.rig);
  if (!options.mode.empty()) fields.set("mode", options.mode);
  if (!options.imu_time_offset.empty()) fields.set("imu_time_offset", options.imu_time_offset);
  if (options.use_sim_time) config.use_sim_time = true;
  config.options.validate();
  return config;
}

void print_counters(const node::Diagnosis& diagnosis) {
  std::puts(diagnosis.message.c_str());
  for (const auto& [key, value] : diagnosis.values)
    if (value != "0") std::puts(fmt::format("  {}: {}", key, value).c_str());
}

int run_ros2(const Ros2Options& options) {
  Ros2Config config = config_of(options);
  if (options.print_config) {
    std::fputs(ConfigFields::of(config).to_yaml().c_str(), stdout);
    return kExitOk;
  }
  if (config.rig.empty())
    throw InputError("--rig is missing: give the name of a rig that ships, or a calibration file");
  const Calibration calibration = node::load_node_rig(config);
  if (!options.quiet && !options.ros.quiet()) show_progress_in_log();
  catch_interrupts();
  const ros2::Discovery discovery = discovery_of(options.place);
  ros2::Ros2Transport transport(
      {discovery, names_of(options.place), config.reliable, config.use_sim_time, options.distribution});
  spdlog::info(fmt::format("rig {}, mode {}, domain {}", config.rig, mode_name(config.mode), discovery.domain));
  node::Node node(config, calibration, transport);
  for (const char* unused : {"events", "image"}) transport.full_name(unused);  // a mode may do without
  transport.check_remappings();
  print_counters(node.run([] { return interrupt_signal() != 0; }));
  return kExitOk;
}

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
  while (interrupt_signal() == 0) {
    const std::string topic = player.unsubscribed();
    if (topic.empty()) break;
    if (status.due()) status.show(fmt::format("waiting for a subscriber to {} (-r renames topics)", topic));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::this_thread::sleep_for(kGrace);
}

void print_sent(const ros2::PlayCounters& counters) {
  std::string text =
      fmt::format("sent {} in {}", quantity(counters.events, "event"), quantity(counters.messages, "message"));
  if (counters.dropped > 0)
    text += fmt::format("; {} dropped, as subscribers did not keep up: lower --rate",
                        quantity(counters.dropped, "message"));
  std::puts(text.c_str());
}

int run_play(const PlayOptions& options) {
  if (!options.ros2) throw InputError("no destination; add --ros2");
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
    print_sent(counters);
  } while (options.loop && !stop());
  return kExitOk;
}

}  // namespace

void add_ros2_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<Ros2Options>();
  CLI::App* ros2 = app.add_subcommand("ros2", "Run on topics of ROS 2, without ROS: reads sensors, publishes poses");
  ros2->add_option("--rig,--calib", options->rig, "Name of a rig that ships, or a calibration file");
  ros2->add_option("--mode", options->mode, "Sensors used beside the IMU: events, frames or fused [fused]");
  ros2->add_option("--imu-time-offset", options->imu_time_offset,
                   "Seconds to add to the stamps of an IMU with an epoch of its own, or auto: found by the rotation of "
                   "the first 10 s [none]");
  add_config_options(*ros2, options->config);
  add_ros2_place(*ros2, options->place, "edged");
  add_ros_arguments(*ros2, options->ros);
  ros2->add_flag("--use-sim-time", options->use_sim_time, "Time from /clock");
  ros2->add_option("--ros-distro", options->distribution,
                   "Show in `ros2 node list` of humble, iron, jazzy, kilted, lyrical or rolling; the wrong one crashes "
                   "nodes of humble");
  ros2->add_flag("--print-config", options->print_config, "Print all options as YAML for --config, and end");
  ros2->add_flag("--quiet", options->quiet, "Only warnings while it runs");
  ros2->footer(
      "Subscribes to events, image, imu, height and velocity (of a further camera NAME: NAME/events, NAME/image);\n"
      "publishes ~/odometry, ~/prediction, ~/pose, ~/path, ~/landmarks, ~/map, ~/occupancy, ~/tracks/..., /tf, "
      "/tf_static,\n"
      "/diagnostics.\n"
      "Obeys ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS, ROS_LOCALHOST_ONLY, CYCLONEDDS_URI.\n"
      "Examples:\n"
      "  edged ros2 --rig davis240c_ecd -r events:=/event_camera/events -r image:=/camera/image_raw -r imu:=/imu/data\n"
      "  edged ros2 --ros-args -p rig:=head.yaml -p base_frame:=base_link -r imu:=/imu/data\n"
      "  edged ros2 --rig head.yaml --mode events --set packets.max_interval_s=0.03 --namespace /drone\n"
      "Ctrl-C ends it with the counters of what was received, and exit code 0.");
  ros2->callback([options, &chosen] { chosen = [options] { return run_ros2(*options); }; });
}

void add_play_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<PlayOptions>();
  CLI::App* play = app.add_subcommand("play", "Play a recording of any format as topics of ROS 2");
  add_source_options(*play, options->source);
  add_cameras_option(*play, options->source);
  play->add_flag("--ros2", options->ros2, "To ROS 2: the only choice so far");
  add_ros2_place(*play, options->place, "edged_play");
  play->add_option("--rate", options->rate, "Speed; 2 is twice as fast as recorded")->check(CLI::Range(0.01, 1000.0));
  play->add_flag("--best-effort", options->best_effort,
                 "Offer best effort, as drivers do; lost messages are not sent again");
  play->add_flag("--wait", options->wait, "Start when the first subscriber is there");
  play->add_flag("--loop", options->loop, "Repeat without end; the clock jumps back");
  const std::string footer =
      "Topics: events (EventPacket), image, imu, height (FluidPressure), velocity (TwistWithCovarianceStamped), "
      "/clock;\n"
      "of a further camera NAME: NAME/events, NAME/image. Stamps are those of the recording.\n"
      "Examples:\n"
      "  edged play flight.bag --ros2 --wait\n"
      "  edged play flight.aedat4 --ros2 --rate 2 -r events:=/event_camera/events";
  finish_command(*play, options, footer, chosen, run_play);
}

}  // namespace edged
