// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics of the node in ROS 1.
#pragma once

#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <topic_tools/shape_shifter.h>

#include <vector>

#include "topics/transport.hpp"

namespace edged::ros1 {

/// Call ros::init before.
class Ros1Transport final : public node::Transport {
 public:
  Ros1Transport();

  Wire wire() const override { return Wire::Ros1; }
  Timestamp now() const override;
  std::unique_ptr<node::Publisher> advertise(const node::Advertised& topic) override;
  std::string full_name(const std::string& topic) const override {
    return topic.starts_with("~/") ? private_.resolveName(topic.substr(2)) : public_.resolveName(topic);
  }
  void subscribe(const std::string& topic, Role role, Receive receive) override;
  void subscribe_type(const std::string& topic, const std::string& /*type*/, bool /*latched*/,
                      Receive receive) override {
    subscribe(topic, {}, std::move(receive));
  }
  void start() override { spinner_.start(); }
  void stop() override { spinner_.stop(); }
  bool ok() const override { return ros::ok(); }
  /// TCP loses nothing, and the type is that of the message.
  std::map<std::string, node::TopicTroubles> troubles() const override { return {}; }

 private:
  ros::NodeHandle public_, private_;
  std::vector<ros::Subscriber> subscriptions_;
  ros::AsyncSpinner spinner_;
};

}  // namespace edged::ros1
