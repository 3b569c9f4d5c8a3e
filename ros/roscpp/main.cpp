// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The node `edged`.
#include <ros/console.h>
#include <ros/init.h>
#include <ros/param.h>
#include <ros/this_node.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <csignal>

#include "edged/core/check.hpp"
#include "node/node.hpp"
#include "roscpp/parameters.hpp"
#include "roscpp/ros1_transport.hpp"

namespace edged::ros1 {
namespace {

constexpr int kBug = 1, kBadInput = 3;  // as of the program `edged`

volatile std::sig_atomic_t caught_signal = 0;
extern "C" void remember_signal(int signal) { caught_signal = signal; }

/// What the library logs goes where ROS logs.
class RosLog final : public spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string text(message.payload.data(), message.payload.size());
    if (message.level >= spdlog::level::err) {
      ROS_ERROR("%s", text.c_str());
    } else if (message.level == spdlog::level::warn) {
      ROS_WARN("%s", text.c_str());
    } else {
      ROS_INFO("%s", text.c_str());
    }
  }
  void flush_() override {}
};

node::NodeConfig load_parameters() {
  node::NodeConfig config;
  XmlRpc::XmlRpcValue parameters;
  ros::param::get(ros::this_node::getName(), parameters);
  set_parameters(config, parameters);
  return config;
}

void run_node() {
  const node::NodeConfig config = load_parameters();
  const Calibration calibration = node::load_node_rig(config);
  ROS_INFO("rig %s, mode %s", config.rig.c_str(), mode_name(config.mode).c_str());
  Ros1Transport transport;
  const node::Diagnosis end = node::Node(config, calibration, transport).run([] { return caught_signal != 0; });
  for (const auto& [key, value] : end.values) ROS_INFO("%s: %s", key.c_str(), value.c_str());
}

}  // namespace
}  // namespace edged::ros1

int main(int argc, char** argv) {
  ros::init(argc, argv, "edged", ros::init_options::NoSigintHandler);
  std::signal(SIGINT, edged::ros1::remember_signal);
  std::signal(SIGTERM, edged::ros1::remember_signal);
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("edged", std::make_shared<edged::ros1::RosLog>()));
  int result = 0;
  try {
    edged::ros1::run_node();
  } catch (const edged::InputError& e) {
    ROS_FATAL("%s", e.what());
    result = edged::ros1::kBadInput;
  } catch (const std::exception& e) {
    ROS_FATAL("internal error: %s", e.what());
    result = edged::ros1::kBug;
  }
  ros::shutdown();
  return result;
}
