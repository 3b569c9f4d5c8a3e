// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Occupied and free voxels by the points that one image shows.
#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Core>
#include <unordered_map>

#include "edged/keyframe_record.hpp"

namespace edged {

/// Each voxel counts once, so that many points in one direction are no more than one. A voxel that is occupied is not
/// free.
class OccupancyScan {
 public:
  /// from_W: position of the camera.
  OccupancyScan(octomap::OcTree& tree, const Eigen::Vector3d& from_W) : tree_(tree), from_W_(from_W) {}

  /// The ray is free up to a voxel and three sigmas before the point. sigma_m: of the point along the ray.
  void free_towards(const Eigen::Vector3d& p_W, double sigma_m);

  /// The voxel of the point is occupied, by how likely it holds the point; not if sigma_m is above half a voxel.
  void occupy(const Eigen::Vector3d& p_W, double sigma_m);

  /// Adds them to the tree, whose inner nodes are not updated.
  void insert();

 private:
  octomap::OcTree& tree_;
  Eigen::Vector3d from_W_;
  octomap::KeyRay ray_;
  octomap::KeySet free_;
  std::unordered_map<octomap::OcTreeKey, float, octomap::OcTreeKey::KeyHash> hits_;  // log-odds
};

/// A scan of each camera: of the landmarks of a keyframe, as estimated when it was marginalized.
void insert_keyframe(octomap::OcTree& tree, const KeyframeRecord& keyframe);

}  // namespace edged
