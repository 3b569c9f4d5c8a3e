// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the robot's base is on the body, whose axes are those of the IMU: by parameter, or from the robot's
// description.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "node/node_config.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// The tree of /tf_static. From any thread.
class StaticTransforms {
 public:
  /// Takes a tf2_msgs/TFMessage; one that is damaged is ignored.
  void add(Wire wire, ByteSpan message);
  /// T_parent_child, also where the two are joined by others; nothing while they are not joined.
  std::optional<SE3> find(const std::string& parent, const std::string& child) const;

 private:
  struct Edge {
    std::string parent;
    SE3 T_parent_child;
  };
  struct FromRoot {
    std::string root;
    SE3 T_root_frame;
  };
  FromRoot from_root(std::string frame) const;

  mutable std::mutex mutex_;
  std::map<std::string, Edge> edges_;  ///< by child
};

class BaseFrame {
 public:
  /// Subscribes to /tf_static if config names a base without its pose. Throws InputError for a pose that is none.
  BaseFrame(Transport& transport, const NodeConfig& config);

  /// T_B_base; nothing while no transform has come. From any thread.
  std::optional<SE3> on_body() const;
  /// T_base_B if it is a parameter: then nobody else publishes it.
  const std::optional<SE3>& given() const { return T_base_B_; }
  /// What it waits for; "" if for nothing.
  std::string waiting_for() const;

 private:
  const FrameNames frames_;
  std::optional<SE3> T_base_B_;
  StaticTransforms transforms_;
};

}  // namespace edged::node
