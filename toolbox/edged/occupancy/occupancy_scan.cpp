// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/occupancy/occupancy_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace edged {
namespace {

constexpr double kMostSigma = 0.5;   // of a point along the ray, over the voxel
constexpr double kFreeSigmas = 3.0;  // before a point, where its ray ends to be free
constexpr double kHit = 0.9;         // probability that a voxel is occupied which surely holds a point
constexpr float kMiss = -0.4F;       // log-odds of a voxel that a ray crosses

octomap::point3d to_octomap(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

}  // namespace

void OccupancyScan::free_towards(const Eigen::Vector3d& p_W, double sigma_m) {
  const Eigen::Vector3d along = (p_W - from_W_).normalized();
  const Eigen::Vector3d free_end = p_W - (tree_.getResolution() + kFreeSigmas * sigma_m) * along;
  if (along.dot(free_end - from_W_) > 0.0 && tree_.computeRayKeys(to_octomap(from_W_), to_octomap(free_end), ray_))
    free_.insert(ray_.begin(), ray_.end());
}

void OccupancyScan::occupy(const Eigen::Vector3d& p_W, double sigma_m) {
  const double voxel = tree_.getResolution();
  octomap::OcTreeKey key;
  if (sigma_m > kMostSigma * voxel || !tree_.coordToKeyChecked(to_octomap(p_W), key)) return;
  const double in_voxel = std::erf(0.5 * voxel / (std::numbers::sqrt2 * sigma_m));  // if its middle is the estimate
  float& hit = hits_[key];
  hit = std::max(hit, octomap::logodds(0.5 + (kHit - 0.5) * in_voxel));
}

void OccupancyScan::insert() {
  // In any order: each voxel is changed once.
  for (const auto& [key, log_odds] : hits_) tree_.updateNode(key, log_odds, true);
  for (const octomap::OcTreeKey& key : free_)
    if (!hits_.contains(key)) tree_.updateNode(key, kMiss, true);
}

void insert_keyframe(octomap::OcTree& tree, const KeyframeRecord& keyframe) {
  for (const KeyframeView& view : keyframe.views) {
    const SE3 T_W_C = keyframe.T_W_B * view.T_B_C;
    OccupancyScan scan(tree, T_W_C.translation());
    for (const KeyframePoint& point : view.points) {
      if (!(point.inverse_depth > 0.0) || !std::isfinite(point.sigma)) continue;
      const Eigen::Vector3d p_C = point.point.homogeneous() / point.inverse_depth;
      const double sigma_m = p_C.norm() * point.sigma / point.inverse_depth;
      scan.free_towards(T_W_C * p_C, sigma_m);
      scan.occupy(T_W_C * p_C, sigma_m);
    }
    scan.insert();
  }
}

}  // namespace edged
