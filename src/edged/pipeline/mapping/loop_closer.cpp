// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/loop_closer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "edged/core/directions.hpp"
#include "edged/core/statistics.hpp"
#include "edged/map/tuning.hpp"

namespace edged {
namespace {

constexpr double kLoopChiSquare = 22.5;  // of six degrees of freedom: 99.9 %

Matrix6d loop_covariance(double position_sigma, double rotation_sigma) {
  Matrix6d P = Matrix6d::Zero();
  P.diagonal().head<3>().setConstant(position_sigma * position_sigma);
  P.diagonal().tail<3>().setConstant(rotation_sigma * rotation_sigma);
  return P;
}

Timestamp loop_age(Timestamp t) { return t - duration_from_seconds(kMapTuning.loop_age_s); }

/// Bound on the drift of the odometry since a keyframe [m].
double drift_since(const MapKeyframe& keyframe, const MapSnapshot& now) {
  return kMapTuning.loop_drift_m + kMapTuning.loop_drift_per_path * (now.path_m - keyframe.path_m);
}

/// Whether an image may show what the keyframe does, with the odometry's drift since, and nothing of it was matched.
bool may_be_in_view(const MapSnapshot& now, std::size_t keyframe, const PosedImage& posed) {
  const MapKeyframe& old = now.map.keyframes()[keyframe];
  if (old.matched_at > now.t - duration_from_seconds(0.5 * kMapTuning.loop_age_s)) return false;
  const auto view = std::ranges::find(old.views, posed.image.camera, &MapView::camera);
  if (view == old.views.end()) return false;
  const SE3 T_M_C = now.T_M_O * posed.T_O_C, T_M_then = now.filter.keyframes()[keyframe] * view->T_B_C;
  const double reach = drift_since(old, now) + kMapTuning.max_distance * view->scene_depth;
  return (T_M_then.translation() - T_M_C.translation()).norm() <= reach &&
         T_M_then.R().col(2).dot(T_M_C.R().col(2)) > std::cos(kMapTuning.max_axis_angle_deg * std::numbers::pi / 180.0);
}

/// The old place that the image shows, if no other resembles it.
std::optional<Recognition> old_place(const MapSnapshot& now, const PosedImage& posed) {
  std::vector<bool> wanted;
  for (std::size_t k = 0; k < now.map.keyframes().size() && now.map.keyframes()[k].t < loop_age(now.t); ++k)
    wanted.push_back(now.map.keyframes()[k].t >= now.since && may_be_in_view(now, k, posed));
  if (std::ranges::find(wanted, true) == wanted.end()) return std::nullopt;
  const auto is_wanted = [&](std::size_t k) { return k < wanted.size() && wanted[k]; };
  const MapQuery query{posed.image.camera, {}, now.filter.keyframes(), is_wanted};
  const ImageFeatures features = features_of(posed);
  const Recognition found = recognize_place(now.map, query, features, posed);
  if (!found.T_M_C || found.agreeing < kMapTuning.loop_inliers) return std::nullopt;
  for (const std::size_t k : found.keyframes) wanted[k] = false;
  const Recognition other = recognize_place(now.map, query, features, posed);
  const bool rivals = other.T_M_C && static_cast<double>(other.agreeing) >=
                                         kMapTuning.loop_rival_share * static_cast<double>(found.agreeing);
  if (rivals && (other.T_M_C->translation() - found.T_M_C->translation()).norm() > kMapTuning.loop_drift_m)
    return std::nullopt;
  return found;
}

}  // namespace

bool drift_explains(const SE3& by_odometry, const SE3& by_place, double drift_m) {
  const Eigen::Quaterniond off = by_odometry.rotation().conjugate() * by_place.rotation();
  const Eigen::Vector3d up = by_odometry.rotation().conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up_by_place = by_place.rotation().conjugate() * Eigen::Vector3d::UnitZ();
  return (by_odometry.translation() - by_place.translation()).norm() <= drift_m &&
         so3::log(off).norm() <=
             kMapTuning.max_turn_rad + kMapTuning.loop_drift_radpm * drift_m / kMapTuning.loop_drift_per_path &&
         angle_between(up, up_by_place) <= kMapTuning.max_turn_rad;
}

bool LoopCloser::loop_needed(const MapSearch& search, const KeyframeMap& map, Timestamp t) const {
  return search.matched_before(map, loop_age(t)) < config_.filter.min_observations;
}

/// Where the body is by the old place in that image, if drift explains the difference, and matching by position does
/// not reach that far.
std::optional<LoopCloser::LoopView> LoopCloser::view(const MapSnapshot& now, const PosedImage& posed,
                                                     std::span<const PosedImage> images) const {
  const std::optional<Recognition> place = old_place(now, posed);
  if (!place) return std::nullopt;
  LoopView view;
  view.T_O_B = now.T_M_O.inverse() * now.filter.T_M_B();
  view.T_M_O = *place->T_M_C * posed.T_O_C.inverse();
  view.loop.drift_m = 0.0;
  double depth = 0.0;
  for (const std::size_t k : place->keyframes) {
    const MapKeyframe& keyframe = now.map.keyframes()[k];
    view.loop.drift_m = std::max(view.loop.drift_m, drift_since(keyframe, now));
    depth = std::max(depth, std::ranges::find(keyframe.views, posed.image.camera, &MapView::camera)->scene_depth);
  }
  const SE3 by_place = view.T_M_O * view.T_O_B;
  if (!drift_explains(now.filter.T_M_B(), by_place, view.loop.drift_m)) return std::nullopt;
  const SE3 off = now.filter.T_M_B().inverse() * by_place;
  const double off_m = off.translation().norm(), off_rad = so3::log(off.rotation()).norm();
  if (posed.image.model.mean_focal() * (off_m / depth + off_rad) < config_.search_px) return std::nullopt;
  return projected(view, now, images);
}

/// The view if the points that should then be in the images match, with the pose that they give.
std::optional<LoopCloser::LoopView> LoopCloser::projected(LoopView view, const MapSnapshot& now,
                                                          std::span<const PosedImage> images) const {
  MapFilter there = filter_at(now.filter, view.T_M_O, view.T_O_B, now.t);
  const MapSearch found = search_map(now.map, there, config_, view.T_M_O, images, {now.since, loop_age(now.t)});
  const std::vector<MapObservation> observations = found.observations();
  if (observations.size() < kMapTuning.loop_inliers) return std::nullopt;
  const std::optional<SE3> T_M_O = there.update(observations, found.candidates.size(), found.T_B_C);
  if (!T_M_O || !drift_explains(now.filter.T_M_B(), *T_M_O * view.T_O_B, view.loop.drift_m)) return std::nullopt;
  std::map<std::uint32_t, int> matches;
  for (const MapObservation& observation : observations) ++matches[observation.keyframe];
  view.loop.keyframe = std::ranges::max_element(matches, {}, [](const auto& each) { return each.second; })->first;
  view.T_M_O = *T_M_O;
  view.loop.T_K_B = there.keyframes()[view.loop.keyframe].inverse() * there.T_M_B();
  return view;
}

std::optional<Loop> LoopCloser::find(const MapSnapshot& now, std::span<const PosedImage> images) {
  if (searched_ && to_seconds(now.t - *searched_) < kMapTuning.loop_interval_s) return std::nullopt;
  searched_ = now.t;
  std::optional<LoopView> found;
  for (const PosedImage& posed : images)
    if (!found) found = view(now, posed, images);
  if (!found) return std::nullopt;
  if (!views_.empty()) {
    const LoopView& last = views_.back();
    const double moved_m = (found->T_O_B.translation() - last.T_O_B.translation()).norm();
    const SE3 between = (last.T_M_O * found->T_O_B).inverse() * (found->T_M_O * found->T_O_B);
    const bool agree = between.translation().norm() < kMapTuning.loop_agreement_m &&
                       so3::log(between.rotation()).norm() < kMapTuning.loop_agreement_rad;
    if (agree && moved_m < kMapTuning.loop_step_m) return std::nullopt;
    if (!agree || moved_m > kMapTuning.loop_gap_m) views_.clear();
  }
  views_.push_back(*found);
  if (views_.size() < kMapTuning.confirming) return std::nullopt;
  views_.clear();
  return found->loop;
}

/// The filter knows neither scale that drifts nor the gyro's: without this it explains the difference by what is left.
std::optional<SE3> LoopCloser::close(MapFilter& filter, const KeyframeMap& map, double path_m, const Loop& loop) {
  const auto keyframe = static_cast<std::uint32_t>(loop.keyframe);
  const MapKeyframe& old = map.keyframes()[keyframe];
  const double drift_m2 = std::pow(loop.drift_m / kMapTuning.gate_sigmas, 2);
  const double path = std::max(path_m - old.path_m, 1e-3);  // [m] of the loop; none at rest
  std::vector<double> drifts_m2;
  for (const MapKeyframe& each : map.keyframes())
    drifts_m2.push_back(each.t > old.t ? drift_m2 * std::clamp((each.path_m - old.path_m) / path, 0.0, 1.0) : 0.0);
  MapFilter inflated = filter;
  inflated.activate(std::span(&keyframe, 1));
  inflated.inflate(drifts_m2, drift_m2, square(kMapTuning.max_turn_rad / kMapTuning.gate_sigmas) / drift_m2);
  const Matrix6d measured = loop_covariance(kMapTuning.confirmed_m, kMapTuning.confirmed_rad);
  if (inflated.squared_distance(keyframe, loop.T_K_B, measured) > kLoopChiSquare) return std::nullopt;
  filter = std::move(inflated);
  return filter.close(keyframe, loop.T_K_B, measured);
}

}  // namespace edged
