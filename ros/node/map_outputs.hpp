// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that show the surroundings: landmarks, the map, and what of it is occupied.
#pragma once

#include <memory>

#include "edged/live/seen_points.hpp"
#include "edged/occupancy/occupancy_worker.hpp"
#include "node/messages.hpp"
#include "topics/period.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// Voxels, and a slice of them as a grid. Made in a thread of its own, and kept for those who subscribe later.
class OccupancyOutputs {
 public:
  /// Throws InputError for heights of the grid in the wrong order.
  OccupancyOutputs(Transport& transport, const NodeConfig& config);
  void add(const std::vector<KeyframeRecord>& keyframes) { worker_->add(keyframes); }
  void clear();

 private:
  void publish(const OccupancyMap& map);
  /// What the grid shows; nothing: the heights of the path, and a voxel.
  static std::optional<HeightRange> heights_of(const OccupancyGridConfig& config);

  const Format format_;
  const double voxel_m_;
  const std::optional<HeightRange> heights_;
  const std::unique_ptr<Publisher> grid_, voxels_;
  bool grid_too_large_ = false, keyframes_left_out_ = false;  ///< that has been reported
  const double period_s_;
  std::optional<OccupancyWorker> worker_;  ///< last member: its thread uses the others
};

/// Landmarks and map are made only for subscribers.
class MapOutputs {
 public:
  MapOutputs(Transport& transport, const NodeConfig& config);
  /// For a step with a pose.
  void publish(const Step& step);
  /// Forgets all places.
  void clear();

 private:
  void publish_map(Timestamp t);

  const Format format_;
  const std::unique_ptr<Publisher> landmarks_, map_;
  SeenPoints points_;
  Period message_;
  std::optional<OccupancyOutputs> occupancy_;
};

}  // namespace edged::node
