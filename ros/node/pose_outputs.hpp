// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that tell where the body and its cameras are: odometry, pose, path and transforms.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "node/messages.hpp"
#include "topics/period.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// A path is made only for a subscriber.
class PoseOutputs {
 public:
  /// T_base_B: sent as a transform, too; nothing if it is that of others.
  PoseOutputs(Transport& transport, const NodeConfig& config, const std::optional<SE3>& T_base_B);
  /// The state of the base in the map.
  void publish(const Estimate& in_map, const SE3& T_map_odom);
  /// The path begins anew.
  void clear() { path_.clear(); }
  /// The cameras as calibrated so far: once, and again, but not often, after their online calibration has changed.
  void publish_cameras(Timestamp t, const Rig& rig);

 private:
  void extend_path(const NavState& state);

  const Format format_;
  const bool publish_tf_;
  const std::optional<SE3> T_base_B_;
  const std::unique_ptr<Publisher> odometry_, pose_, path_topic_, transforms_, static_transforms_;
  Period path_step_, path_message_, cameras_message_;
  std::deque<StampedPose> path_;
  std::map<std::string, SE3> sent_cameras_;  ///< T_B_C
};

}  // namespace edged::node
