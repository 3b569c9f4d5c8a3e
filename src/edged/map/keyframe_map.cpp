// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/keyframe_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "edged/core/statistics.hpp"
#include "edged/map/tuning.hpp"

namespace edged {
namespace {

/// How reliably it has been matched so far.
double reliability(const MapPoint& point) { return (1.0 + point.matched) / (2.0 + point.searched); }

/// Pixels of the image by pixels of the patch, for a plane through the point, parallel to the image plane of its
/// keyframe. The calibration may have changed since then: only differences of its rays count.
std::optional<Eigen::Matrix2d> patch_warp(const MapPoint& point, const SE3& T_now_then, const CameraModel& camera) {
  const auto seen = [&](const Eigen::Vector2d& pixel) {
    return camera.project(T_now_then * (camera.pixel_to_point(pixel).homogeneous() / point.inverse_depth));
  };
  const auto centre = seen(point.pixel);
  if (!centre) return std::nullopt;
  Eigen::Matrix2d A;
  for (int axis = 0; axis < 2; ++axis) {
    const auto beside = seen(point.pixel + Eigen::Vector2d::Unit(axis));
    if (!beside) return std::nullopt;
    A.col(axis) = *beside - *centre;
  }
  return A;
}

}  // namespace

MappedKeyframe mapped(const MapKeyframe& keyframe, const SE3& T_M_K) {
  MappedKeyframe seen{keyframe.t, T_M_K, "", keyframe.times_matched, keyframe.matched_at, {}};
  for (const MapView& view : keyframe.views) {
    seen.camera += (seen.camera.empty() ? "" : " ") + view.camera;
    for (const MapPoint& point : view.points) {
      const Eigen::Vector3d p_K = view.T_B_C * (point.point.homogeneous() / point.inverse_depth);
      seen.points.push_back({T_M_K * p_K, point.patch.middle(), point.searched, point.matched});
    }
  }
  return seen;
}

bool KeyframeMap::prune_points(MapKeyframe& keyframe) const {
  const bool soon =
      !keyframes_.empty() && to_seconds(keyframe.t - keyframes_.back().t) < kMapTuning.keyframe_interval_s;
  if (soon) return false;
  for (MapView& view : keyframe.views) keep_best(view.points);
  std::erase_if(keyframe.views,
                [&](const MapView& view) { return static_cast<int>(view.points.size()) < config_.min_points; });
  return !keyframe.views.empty();
}

void KeyframeMap::keep_best(std::vector<MapPoint>& points) const {
  std::erase_if(
      points, [&](const MapPoint& point) { return !(point.sigma < kMapTuning.max_depth_error * point.inverse_depth); });
  if (static_cast<int>(points.size()) <= config_.max_points) return;
  std::ranges::stable_sort(points, {}, [](const MapPoint& p) { return p.sigma / p.inverse_depth; });
  points.resize(static_cast<std::size_t>(config_.max_points));
}

void KeyframeMap::add(MapKeyframe keyframe) {
  for (MapView& view : keyframe.views) {
    std::vector<double> inverse;
    PlaceIndex& places = places_[view.camera];
    for (const MapPoint& point : view.points) {
      inverse.push_back(point.inverse_depth);
      if (point.descriptor) places.add(keyframes_.size(), *point.descriptor);
    }
    view.scene_depth = 1.0 / median(std::move(inverse));
  }
  keyframes_.push_back(std::move(keyframe));
}

std::optional<std::size_t> KeyframeMap::redundant_keyframe(TimeInterval created) const {
  if (static_cast<int>(keyframes_.size()) <= config_.max_keyframes) return std::nullopt;
  const auto outside = [&](const MapKeyframe& keyframe) { return !created.contains(keyframe.t); };
  const auto begin = std::find_if_not(keyframes_.begin(), keyframes_.end(), outside);
  const auto end = std::prev(keyframes_.end());
  if (begin >= end) return std::nullopt;
  return static_cast<std::size_t>(std::ranges::min_element(begin, end, {}, &MapKeyframe::matched_at) -
                                  keyframes_.begin());
}

void KeyframeMap::remove(std::size_t keyframe) {
  for (auto& [camera, places] : places_) places.remove(keyframe);
  keyframes_.erase(keyframes_.begin() + static_cast<std::ptrdiff_t>(keyframe));
}

void KeyframeMap::record_search(const Candidate& candidate, Timestamp t) {
  ++candidate.point->searched;
  if (!candidate.matched) return;
  ++candidate.point->matched;
  MapKeyframe& keyframe = keyframes_[candidate.observation.keyframe];
  keyframe.times_matched += keyframe.matched_at == t ? 0 : 1;
  keyframe.matched_at = t;
}

std::vector<KeyframeMap::ViewIndex> KeyframeMap::queried_views(const MapQuery& query) const {
  std::vector<ViewIndex> views;
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    if (!query.created.contains(keyframes_[k].t) || (query.wanted && !query.wanted(k))) continue;
    const auto view = std::ranges::find(keyframes_[k].views, query.camera, &MapView::camera);
    if (view == keyframes_[k].views.end()) continue;
    views.push_back({k, static_cast<std::size_t>(view - keyframes_[k].views.begin())});
  }
  return views;
}

std::vector<KeyframeMap::ViewIndex> KeyframeMap::nearby_views(const MapQuery& query, const SE3& T_M_C) const {
  const double widest = std::cos(kMapTuning.max_axis_angle_deg * std::numbers::pi / 180.0);
  std::vector<std::pair<double, ViewIndex>> found;
  for (const ViewIndex& each : queried_views(query)) {
    const MapView& view = keyframes_[each.keyframe].views[each.view];
    const SE3 T_M_then = query.T_M_K[each.keyframe] * view.T_B_C;
    const double distance = (T_M_then.translation() - T_M_C.translation()).norm() / view.scene_depth;
    const double cosine = T_M_then.R().col(2).dot(T_M_C.R().col(2));
    if (distance < kMapTuning.max_distance && cosine > widest) found.emplace_back(distance + 1.0 - cosine, each);
  }
  const auto most = std::min<std::ptrdiff_t>(kMapTuning.nearest_keyframes, std::ssize(found));
  std::ranges::stable_sort(found, {}, &std::pair<double, ViewIndex>::first);
  std::vector<ViewIndex> nearest;
  for (auto it = found.begin(); it != found.begin() + most; ++it) nearest.push_back(it->second);
  return nearest;
}

std::vector<Candidate> KeyframeMap::visible(const MapQuery& query, const SE3& T_M_C, const CameraModel& camera,
                                            int most) {
  const double widest = std::cos(kMapTuning.max_view_angle_deg * std::numbers::pi / 180.0);
  const SE3 T_C_M = T_M_C.inverse();
  std::vector<Candidate> found;
  for (const ViewIndex& each : nearby_views(query, T_M_C)) {
    MapView& view = keyframes_[each.keyframe].views[each.view];
    const SE3 T_C_K = T_C_M * query.T_M_K[each.keyframe] * view.T_B_C;
    for (MapPoint& point : view.points) {
      if (point.searched >= kMapTuning.reliable_searches &&
          point.matched < kMapTuning.min_matched_share * point.searched)
        continue;
      const Eigen::Vector3d p_K = point.point.homogeneous() / point.inverse_depth, p_C = T_C_K * p_K;
      const auto pixel = camera.project(p_C);
      if (!pixel || !camera.contains(*pixel, kMapTuning.margin_px)) continue;
      const double scale = p_C.norm() / p_K.norm();
      const double cosine = (T_C_K.R() * p_K).dot(p_C) / (p_K.norm() * p_C.norm());
      if (scale > kMapTuning.max_scale || scale < 1.0 / kMapTuning.max_scale || cosine < widest) continue;
      const auto A = patch_warp(point, T_C_K, camera);
      if (!A) continue;
      const Eigen::Vector3d depth_sigma_K = view.T_B_C.R() * p_K * (point.sigma / point.inverse_depth);
      found.push_back({.observation = {static_cast<std::uint32_t>(each.keyframe), view.T_B_C * p_K, depth_sigma_K},
                       .point = &point,
                       .pixel = *pixel,
                       .A = *A});
    }
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, [](const Candidate& c) { return reliability(*c.point); });
  std::set<std::pair<int, int>> taken;
  std::erase_if(found, [&](const Candidate& c) {
    return static_cast<int>(taken.size()) >= most || !taken
                                                          .emplace(static_cast<int>(c.pixel.x()) / kMapTuning.cell_px,
                                                                   static_cast<int>(c.pixel.y()) / kMapTuning.cell_px)
                                                          .second;
  });
  return found;
}

/// The views of the query with the most votes of the descriptors, in the order of their keyframes.
std::vector<KeyframeMap::ViewIndex> KeyframeMap::candidate_views(
    const MapQuery& query, std::span<const std::optional<Descriptor>> descriptors) const {
  std::vector<ViewIndex> views = queried_views(query);
  if (views.size() <= kMapTuning.compared_keyframes) return views;
  const std::vector<std::uint32_t> votes = places_.find(query.camera)->second.votes(descriptors, keyframes_.size());
  std::ranges::stable_sort(views, std::ranges::greater{}, [&](const ViewIndex& each) { return votes[each.keyframe]; });
  views.resize(kMapTuning.compared_keyframes);
  std::ranges::sort(views, {}, &ViewIndex::keyframe);
  return views;
}

/// For each descriptor the most similar point, the first of several. The outer loop is over points, as the descriptors
/// of an image stay in the cache and those of the map do not.
std::vector<KeyframeMap::DescriptorMatch> KeyframeMap::match_descriptors(
    const MapQuery& query, std::span<const std::optional<Descriptor>> descriptors) const {
  std::vector<DescriptorMatch> alike(descriptors.size(), DescriptorMatch{kMaxDescriptorBits, {}, nullptr});
  for (const ViewIndex& each : candidate_views(query, descriptors)) {
    for (const MapPoint& point : keyframes_[each.keyframe].views[each.view].points) {
      if (!point.descriptor) continue;
      for (std::size_t i = 0; i < descriptors.size(); ++i) {
        if (!descriptors[i]) continue;
        const int bits = distance(*descriptors[i], *point.descriptor);
        if (bits < alike[i].bits) alike[i] = {bits, each, &point};
      }
    }
  }
  return alike;
}

Recognition KeyframeMap::recognize(const MapQuery& query, std::span<const std::optional<Descriptor>> descriptors,
                                   std::span<const Eigen::Vector2d> points, const Eigen::Quaterniond& R_O_C,
                                   double focal) const {
  const std::vector<DescriptorMatch> alike = match_descriptors(query, descriptors);
  std::vector<PlaceMatch> matches;
  std::vector<std::size_t> keyframes;
  for (std::size_t i = 0; i < alike.size(); ++i) {
    const auto& [bits, of, point] = alike[i];
    if (point == nullptr) continue;
    const SE3& T_B_C = keyframes_[of.keyframe].views[of.view].T_B_C;
    const Eigen::Vector3d p_K = T_B_C * (point->point.homogeneous() / point->inverse_depth);
    matches.push_back({points[i], query.T_M_K[of.keyframe] * p_K});
    keyframes.push_back(of.keyframe);
  }
  Recognition found;
  found.similar = matches.size();
  const std::optional<PlacePose> pose = pose_by_gravity(matches, R_O_C, kMapTuning.agreement_px / focal);
  if (!pose) return found;
  found.agreeing = pose->agreeing;
  if (found.agreeing >= kMapTuning.min_inliers &&
      static_cast<double>(found.agreeing) >= kMapTuning.min_inlier_share * static_cast<double>(found.similar))
    found.T_M_C = pose->T_M_C;
  if (!found.T_M_C) return found;
  const SE3 T_C_M = pose->T_M_C.inverse();
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (agrees(matches[i], T_C_M, kMapTuning.agreement_px / focal)) found.keyframes.insert(keyframes[i]);
  }
  return found;
}

}  // namespace edged
