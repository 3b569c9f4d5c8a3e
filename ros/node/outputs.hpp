// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that the node publishes, but those at the rate of the IMU.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "node/map_outputs.hpp"
#include "node/pose_outputs.hpp"

namespace edged::node {

/// All messages but poses and transforms are made only for subscribers.
class Outputs {
 public:
  /// T_base_B: as PoseOutputs. Throws InputError for heights of the grid in the wrong order.
  Outputs(Transport& transport, const NodeConfig& config, const std::optional<SE3>& T_base_B);

  /// Advertises the tracked images of a camera. topic: "events", "frames", or its name.
  void add_camera(const std::string& name, const std::string& topic);
  /// The cameras of the mode as calibrated so far.
  void publish_cameras(Timestamp t, const Rig& rig) { poses_.publish_cameras(t, rig); }
  /// The results of one packet. base: its state in the map, nothing while its place on the body is unknown.
  void publish(const Step& step, const std::optional<Estimate>& base, const SE3& T_map_odom);
  /// Before poses in another map: forgets path and places.
  void clear() {
    poses_.clear();
    map_.clear();
  }
  void publish(const Diagnosis& diagnosis, const std::string& hardware) const;

 private:
  void publish_images(const Step& step) const;

  Transport& transport_;
  const Format format_;
  PoseOutputs poses_;
  MapOutputs map_;
  std::map<std::string, std::unique_ptr<Publisher>> tracks_;  ///< by camera
  const std::unique_ptr<Publisher> diagnostics_;
};

}  // namespace edged::node
