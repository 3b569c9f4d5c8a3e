// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Names of ROS 2 as DDS has them: topics, types and the hashes of types.
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace edged::ros2 {

/// A message type that is written or read.
struct MessageType {
  std::string_view name;  ///< "sensor_msgs/Imu", as the readers of bags have it
  std::string_view hash;  ///< hash of its definition (REP-2016), in hex
};
std::span<const MessageType> message_types();

/// "sensor_msgs/Imu" -> "sensor_msgs::msg::dds_::Imu_".
std::string dds_type(std::string_view type);
/// The reverse; "" for what is no message of ROS 2.
std::string ros_type(std::string_view dds_type);
/// "/imu/data" -> "rt/imu/data"; a topic without a slash is none of nodes and stays.
std::string dds_topic(std::string_view topic);
/// USER_DATA of an endpoint; "" for a type whose hash is not known.
std::string type_hash_data(std::string_view type);

/// Resolves names as ROS does: a name with a slash is absolute, "~/name" is the node's own, others are in its
/// namespace. Then the first remapping that fits is applied.
class Names {
 public:
  /// remappings: "from:=to". Those of "__ns" and "__node" name namespace and node. Throws InputError for what is no
  /// remapping or no valid name.
  Names(std::string name_space, std::string node, const std::vector<std::string>& remappings);

  std::string full_name(const std::string& topic) const;
  /// Throws InputError for a remapping of a name that full_name() was never asked for, with those that it was.
  void check_remappings() const;
  /// "/robot/edged"
  std::string full_node_name() const { return expand(node_); }
  const std::string& name_space() const { return name_space_; }  ///< "/" or "/robot"
  const std::string& node() const { return node_; }

 private:
  std::string expand(const std::string& topic) const;

  std::string name_space_, node_;
  std::map<std::string, std::string> remapped_;  ///< full names
  mutable std::set<std::string> asked_for_;      ///< before remapping
};

}  // namespace edged::ros2
