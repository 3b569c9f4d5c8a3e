// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Topics in, the odometry, topics out.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <set>

#include "edged/io/calibration_data.hpp"
#include "edged/odometry.hpp"
#include "node/autopilot_outputs.hpp"
#include "node/backlog.hpp"
#include "node/clock_check.hpp"
#include "node/outputs.hpp"
#include "node/sensor_input.hpp"

namespace edged::node {

/// Threads of the transport add measurements and publish the prediction; the thread of run() estimates and publishes
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
  void subscribe(const std::string& topic, Role role, const std::string& camera);
  void receive(const std::function<bool()>& stop);
  void on_message(const std::string& topic, SensorInput& input, const WireMessage& message);
  void fail(std::exception_ptr failure);
  bool failed();
  void predict(const ImuSample& sample);
  bool make_step();
  void report(const Step& step);
  void report_troubles(const NodeHealth& health);
  NodeHealth health();  ///< counters of the last call, to find new losses
  Diagnosis publish_diagnostics();
  void wait();

  /// The sample that was the newest at t.
  Eigen::Vector3d gyro_at(Timestamp t);

  Transport& transport_;
  const std::string rig_name_;
  Odometry odometry_;
  Backlog backlog_;
  Outputs outputs_;
  AutopilotOutputs autopilot_;
  std::optional<ClockCheck> clocks_;
  std::optional<TrackingStatus> status_;
  std::string reason_;
  std::size_t lost_ = 0;        ///< as of the last report
  std::set<std::string> said_;  ///< troubles that have been reported

  std::mutex mutex_;  // of what is below
  std::condition_variable added_;
  bool something_new_ = false;
  std::exception_ptr failure_;  // the first one of a thread of the transport
  std::deque<ImuSample> recent_imu_;
  std::optional<StateCovariance> covariance_;

  std::map<std::string, SensorInput> inputs_;  // by topic; not changed after the constructor
};

}  // namespace edged::node
