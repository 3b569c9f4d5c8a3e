// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Topics in, the odometry, topics out.
#pragma once

#include <functional>

#include "edged/io/calibration_data.hpp"
#include "edged/odometry.hpp"
#include "node/base_frame.hpp"
#include "node/imu_rate_outputs.hpp"
#include "node/inputs.hpp"
#include "node/odom_frame.hpp"
#include "node/outputs.hpp"
#include "node/requests.hpp"
#include "node/status_log.hpp"

namespace edged::node {

/// Threads of the transport queue measurements and publish the prediction; the thread of run() estimates and publishes
/// the rest.
class Node {
 public:
  /// Subscribes and advertises. Throws InputError when the rig lacks a camera that the mode needs, or two sensors have
  /// one topic.
  Node(const NodeConfig& config, const Calibration& calibration, Transport& transport);

  /// Until `stop` returns true or ROS shuts down; measurements until then are processed. Returns the counters at the
  /// end. Throws what goes wrong here or in a thread of the transport, which has been stopped then.
  Diagnosis run(const std::function<bool()>& stop);

 private:
  void load_map(const NodeConfig& config);
  void serve(const Request& request);
  std::string result_of(const Request& request);
  std::string save_map(const std::string& file) const;
  void start_anew(Odometry fresh);
  void receive(const std::function<bool()>& stop);
  void add_waiting();
  bool make_step();
  Diagnosis publish_diagnostics();

  Transport& transport_;
  const std::string rig_name_;
  const std::function<Odometry()> make_odometry_;
  Odometry odometry_;
  std::string loaded_map_;  ///< of map.localize_only, for a reset
  BaseFrame base_;
  OdomFrame odom_;
  Outputs outputs_;
  ImuRateOutputs imu_rate_;
  Inputs inputs_;
  StatusLog log_;
  Requests requests_;
  std::string served_;  ///< the last request, and its result
  std::optional<Timestamp> newest_step_;
};

}  // namespace edged::node
