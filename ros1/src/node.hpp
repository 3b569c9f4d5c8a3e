// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Topics in, the odometry, topics out.
#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <topic_tools/shape_shifter.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>

#include "backlog.hpp"
#include "edged/io/sensor_head.hpp"
#include "edged/odometry.hpp"
#include "outputs.hpp"
#include "sensor_input.hpp"

namespace edged::ros1 {

/// Threads of ROS add measurements and publish the prediction; the thread of run() estimates and publishes the rest.
class Node {
 public:
  /// Throws InputError when the rig lacks a camera that the mode needs.
  Node(const NodeConfig& config, const Calibration& calibration);

  /// Until `stop` returns true or ROS shuts down; measurements until then are processed.
  void run(const std::function<bool()>& stop);

 private:
  void subscribe(const std::string& topic, Role role, const std::string& camera);
  void on_message(SensorInput& input, const topic_tools::ShapeShifter& message);
  void predict(const ImuSample& sample);
  bool make_step();
  void report(const Step& step);
  NodeHealth health();  ///< counters of the last call, to find new losses
  diagnostic_msgs::DiagnosticStatus publish_diagnostics();
  void wait();

  /// The sample that was the newest at t.
  Eigen::Vector3d gyro_at(Timestamp t);

  ros::NodeHandle public_, private_;
  const std::string rig_name_;
  Odometry odometry_;
  Backlog backlog_;
  Outputs outputs_;
  std::optional<TrackingStatus> status_;
  std::string reason_;
  std::size_t lost_ = 0;  ///< as of the last report

  std::mutex mutex_;  // of what is below
  std::condition_variable added_;
  bool something_new_ = false;
  std::deque<ImuSample> recent_imu_;
  std::optional<StateCovariance> covariance_;

  std::map<std::string, SensorInput> inputs_;   // by topic
  std::vector<ros::Subscriber> subscriptions_;  // after what their threads use
  ros::AsyncSpinner spinner_;
};

}  // namespace edged::ros1
