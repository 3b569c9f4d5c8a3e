// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The configuration of the node, from its private parameters.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>

#include "edged/options.hpp"
#include "edged/pipeline/sequencer.hpp"

namespace edged::ros1 {

/// Names of the frames in tf.
struct FrameNames {
  std::string world = "odom";  ///< W
  std::string body = "body";   ///< B, the IMU
};

struct NodeConfig {
  std::string rig;
  Mode mode = Mode::Fused;
  FrameNames frames;
  bool publish_tf = true;
  SensorDelays delays;
  double max_age_s = 0.25;
  double path_step_s = 0.1;
  OdometryConfig options;

  void visit(ConfigFields& fields);
};

/// Sets what `parameters`, the tree of the private ones, holds; `~options/packets/max_age_s` is the option
/// expert.packets.max_age_s. Throws InputError that names the parameter, with the nearest known one for a typing error.
void set_parameters(NodeConfig& config, XmlRpc::XmlRpcValue parameters);

}  // namespace edged::ros1
