// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that tell where the body and its cameras are: odometry, pose, path and transforms.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "node/messages.hpp"
#include "topics/period.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// A path is made only for a subscriber.
class PoseOutputs {
 public:
  PoseOutputs(Transport& transport, const NodeConfig& config);
  void publish(const Estimate& estimate);
  /// The cameras as calibrated so far: once, and again, but not often, after their online calibration has changed.
  void publish_cameras(Timestamp t, const Rig& rig);

 private:
  void extend_path(const NavState& state);

  const Format format_;
  const bool publish_tf_;
  const std::unique_ptr<Publisher> odometry_, pose_, path_topic_, transforms_, static_transforms_;
  Period path_step_, path_message_, cameras_message_;
  std::deque<StampedPose> path_;
  std::map<std::string, SE3> sent_cameras_;  ///< T_B_C
};

}  // namespace edged::node
