// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/map_outputs.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "edged/core/check.hpp"

namespace edged::node {
namespace {

constexpr std::size_t kLandmarksQueue = 2;  // messages that may wait for a slow subscriber
constexpr std::size_t kMostMapPoints = 20'000;
constexpr double kMostCells = 16e6;  // of the occupancy grid: 200 m by 200 m in voxels of 5 cm
constexpr Duration kMapPeriod = std::chrono::seconds(2);

}  // namespace

OccupancyOutputs::OccupancyOutputs(Transport& transport, const NodeConfig& config)
    : format_{transport.wire(), config.frame_names()},
      voxel_m_(config.occupancy.voxel_m),
      heights_(heights_of(config.occupancy)),
      grid_(transport.advertise({"~/occupancy", "nav_msgs/OccupancyGrid", 1, true})),
      voxels_(transport.advertise({"~/octomap", "octomap_msgs/Octomap", 1, true})),
      period_s_(config.occupancy.period_s) {
  clear();
}

void OccupancyOutputs::clear() {
  worker_.reset();  // which publishes what waits
  worker_.emplace(voxel_m_, period_s_, [this](const OccupancyMap& map) { publish(map); });
}

std::optional<HeightRange> OccupancyOutputs::heights_of(const OccupancyGridConfig& config) {
  if (config.low_m == 0.0 && config.high_m == 0.0) return std::nullopt;
  if (config.low_m >= config.high_m)
    throw InputError::format("occupancy.low_m {:g}: must be below occupancy.high_m {:g}", config.low_m, config.high_m);
  return HeightRange{config.low_m, config.high_m};
}

void OccupancyOutputs::publish(const OccupancyMap& map) {
  if (map.left_out > 0 && !std::exchange(keyframes_left_out_, true))
    spdlog::warn(
        "occupancy map: keyframes are left out, as it is too large or made too slowly; choose a larger "
        "occupancy.voxel_m");
  voxels_->publish(octomap_message(format_, map.t, map.tree));
  const HeightRange of_path{map.path.low_m - voxel_m_, map.path.high_m + voxel_m_};
  try {
    if (const auto slice = slice_of(map.tree, heights_.value_or(of_path), kMostCells))
      grid_->publish(occupancy_message(format_, map.t, *slice, voxel_m_));
  } catch (const InputError& e) {
    if (!std::exchange(grid_too_large_, true)) spdlog::warn(fmt::format("occupancy grid: {}", e.what()));
  }
}

MapOutputs::MapOutputs(Transport& transport, const NodeConfig& config)
    : format_{transport.wire(), config.frame_names()},
      landmarks_(transport.advertise({"~/landmarks", "sensor_msgs/PointCloud2", kLandmarksQueue})),
      map_(transport.advertise({"~/map", "sensor_msgs/PointCloud2", 1})),
      points_(kMostMapPoints),
      message_(kMapPeriod) {
  if (config.occupancy.voxel_m > 0.0) occupancy_.emplace(transport, config);
}

void MapOutputs::publish(const Step& step) {
  if (!step.landmarks.empty() && landmarks_->wanted())
    landmarks_->publish(landmarks_message(format_, step.t, step.landmarks));
  if (step.keyframe) points_.add(step.landmarks);
  if (occupancy_) occupancy_->add(step.marginalized_keyframes);
  publish_map(step.t);
}

void MapOutputs::clear() {
  points_ = SeenPoints(kMostMapPoints);
  if (occupancy_) occupancy_->clear();
}

void MapOutputs::publish_map(Timestamp t) {
  if (points_.all().empty() || !map_->wanted() || !message_.begins(t)) return;
  std::vector<Landmark> points;
  for (const auto& [id, p] : points_.all()) points.push_back({id, Eigen::Vector3d(p[0], p[1], p[2])});
  map_->publish(landmarks_message(format_, t, points));
}

}  // namespace edged::node
