// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "commands/ros2_options.hpp"
#include "common/config_source.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "dds/ros2_transport.hpp"
#include "edged/core/check.hpp"
#include "node/node.hpp"
#include "program/commands.hpp"

namespace edged {
namespace {

/// Options of the odometry have the keys that they have in `edged run`.
struct Ros2Config : node::NodeConfig {
  bool reliable = false;
  bool use_sim_time = false;
  QueueConfig live;  ///< of `edged run` alone, whose files are to load here

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
  std::string rig, mode, distribution;
  ConfigSource config;
  Ros2Place place;
  bool use_sim_time = false;
  bool print_config = false;
  bool quiet = false;
};

Ros2Config config_of(const Ros2Options& options) {
  Ros2Config config;
  ConfigFields fields = ConfigFields::of(config);
  if (!options.config.file.empty()) fields.load(options.config.file);
  for (const std::string& assignment : options.config.assignments) fields.set(assignment);
  if (!options.rig.empty()) fields.set("rig", options.rig);
  if (!options.mode.empty()) fields.set("mode", options.mode);
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
  if (!options.quiet) show_progress_in_log();
  catch_interrupts();
  const ros2::Discovery discovery = discovery_of(options.place);
  ros2::Ros2Transport transport(
      {discovery, names_of(options.place), config.reliable, config.use_sim_time, options.distribution});
  spdlog::info(fmt::format("rig {}, mode {}, domain {}", config.rig, mode_name(config.mode), discovery.domain));
  node::Node node(config, calibration, transport);
  print_counters(node.run([] { return interrupt_signal() != 0; }));
  return kExitOk;
}

}  // namespace

void add_ros2_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<Ros2Options>();
  CLI::App* ros2 = app.add_subcommand("ros2", "Run on topics of ROS 2, without ROS: reads sensors, publishes poses");
  ros2->add_option("--rig", options->rig, "Name of a rig that ships, or a calibration file");
  ros2->add_option("--mode", options->mode, "Sensors used beside the IMU: events, frames or fused [fused]");
  add_config_options(*ros2, options->config);
  add_ros2_place(*ros2, options->place, "edged");
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
      "  edged ros2 --rig head.yaml --mode events --set packets.max_interval_s=0.03 --namespace /drone\n"
      "Ctrl-C ends it with the counters of what came, and exit code 0.");
  ros2->callback([options, &chosen] { chosen = [options] { return run_ros2(*options); }; });
}

}  // namespace edged
