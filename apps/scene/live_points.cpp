// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "scene/live_points.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "report/point_cloud.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostKeyframes = 1000;  // whose depth map has not come

}  // namespace

void LivePoints::note_keyframe(Timestamp t, const SE3& T_M_O) {
  const std::lock_guard lock(mutex_);
  keyframes_.push_back({t, T_M_O});
  if (keyframes_.size() > kMostKeyframes) keyframes_.pop_front();
}

void LivePoints::add(const DepthMap& map) {
  SE3 T_M_C = map.T_O_C;
  {
    const std::lock_guard lock(mutex_);
    const auto keyframe = std::ranges::lower_bound(keyframes_, map.t, {}, &Keyframe::t);
    if (keyframe == keyframes_.end() || keyframe->t != map.t) return;
    T_M_C = keyframe->T_M_O * T_M_C;
  }
  std::vector<Point> points;
  for (const DensePoint& point : map.points)
    points.push_back({(T_M_C * point.in_camera(map.pinhole)).cast<float>(), point.grey});
  const std::lock_guard lock(mutex_);
  for (const Point& point : points) points_.add(point);
  all_ += points.size();
}

nlohmann::ordered_json LivePoints::news(Place& place) const {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint8_t> grey;
  std::size_t halved = 0, from = 0, all = 0;
  {
    const std::lock_guard lock(mutex_);
    halved = points_.halvings() - std::exchange(place.halvings, points_.halvings());
    for (std::size_t i = 0; i < halved; ++i) place.points = (place.points + 1) / 2;
    from = place.points;
    const std::size_t end = std::min(points_.all().size(), place.points + kMostAtOnce);
    for (; place.points < end; ++place.points) {
      points.push_back(points_.all()[place.points].p_M);
      grey.push_back(points_.all()[place.points].grey);
    }
    all = all_;
  }
  if (points.empty() && halved == 0) return nullptr;
  nlohmann::ordered_json json = packed_json(points, grey);
  json["halved"] = halved;
  json["from"] = from;
  json["all"] = all;
  return json;
}

void LivePoints::set_voxels(const std::vector<Eigen::Vector3f>& centres, double edge_m) {
  std::vector<Eigen::Vector3f> chosen;
  const std::size_t kept = std::min(kMostVoxels, centres.size());
  for (std::size_t i = 0; i < kept; ++i) chosen.push_back(centres[i * centres.size() / kept]);
  const std::lock_guard lock(mutex_);
  voxels_ = std::move(chosen);
  voxel_m_ = edge_m;
  all_voxels_ = centres.size();
  ++voxels_number_;
}

nlohmann::ordered_json LivePoints::new_voxels(Place& place) const {
  std::unique_lock lock(mutex_);
  if (std::exchange(place.voxels, voxels_number_) == voxels_number_) return nullptr;
  const std::vector<Eigen::Vector3f> voxels = voxels_;
  const double edge_m = voxel_m_;
  const std::size_t all = all_voxels_;
  lock.unlock();
  nlohmann::ordered_json json = packed_json(voxels, {});
  json["all"] = all;
  json["edge_m"] = edge_m;
  json["axes"] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return json;
}

}  // namespace edged
