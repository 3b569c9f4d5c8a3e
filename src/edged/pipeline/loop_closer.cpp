// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Loop closure: old places that are recognized by appearance while the odometry is good, where its drift is too large
// to match them by position.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "edged/pipeline/mapper.hpp"

namespace edged {
namespace {

constexpr double kLoopInterval_s = 0.5;  // between images that are compared with old places
constexpr double kLoopAge_s = 20.0;      // of keyframes that are old
constexpr double kLoopUnmatched_s = 10.0;
// Bound on the drift of the odometry.
constexpr double kLoopDrift_m = 0.3, kLoopDriftPerPath = 0.02;
constexpr double kLoopDrift_rad = 0.1, kLoopDrift_radpm = 5e-4;
constexpr double kLoopReach = 1.5;        // [scene depths]: from farther away a place has another appearance
constexpr double kLoopWidest_deg = 60.0;  // between optical axes
constexpr std::size_t kLoopInliers = 12;
constexpr double kLoopRival = 0.6;                            // share of the inliers that another place may have
constexpr double kSecondPlace_m = 0.3;                        // poses further apart are two places
constexpr std::size_t kLoopViews = 3;                         // that agree
constexpr double kLoopStep_m = 0.25, kLoopGap_m = 4.0;        // path between these
constexpr double kLoopAgree_m = 0.15, kLoopAgree_rad = 0.03;  // of two of them
constexpr double kLoopSigma_m = 0.05, kLoopSigma_rad = 0.02;  // of the pose relative to a keyframe, then
constexpr double kLoopChiSquare = 22.5;                       // of six: 99.9 %

Matrix6d loop_covariance(double position_sigma, double rotation_sigma) {
  Matrix6d P = Matrix6d::Zero();
  P.diagonal().head<3>().setConstant(position_sigma * position_sigma);
  P.diagonal().tail<3>().setConstant(rotation_sigma * rotation_sigma);
  return P;
}

Timestamp loop_age(Timestamp t) { return t - duration_from_seconds(kLoopAge_s); }

}  // namespace

double Mapper::drift_since(const MapKeyframe& keyframe) const {
  return kLoopDrift_m + kLoopDriftPerPath * (path_m_ - keyframe.path_m);
}

/// Whether enough old points are matched by position, so that there is no loop to close.
bool Mapper::holds(const Search& search, Timestamp t) const {
  return found_before(search, loop_age(t)) >= config_.filter.min_observations;
}

/// Whether an image may show what the keyframe does, with the odometry's drift since, and nothing of it was matched.
bool Mapper::may_be_in_view(std::size_t keyframe, Timestamp t, const PosedImage& posed) const {
  const MapKeyframe& old = map_.keyframes()[keyframe];
  if (old.found_at > t - duration_from_seconds(kLoopUnmatched_s)) return false;
  const auto view = std::ranges::find(old.views, posed.image.camera, &MapView::camera);
  if (view == old.views.end()) return false;
  const SE3 T_M_C = odom_to_map_.T_M_O() * posed.T_O_C, T_M_then = filter_.keyframes()[keyframe] * view->T_B_C;
  const double reach = drift_since(old) + kLoopReach * view->scene_depth;
  return (T_M_then.translation() - T_M_C.translation()).norm() <= reach &&
         T_M_then.R().col(2).dot(T_M_C.R().col(2)) > std::cos(kLoopWidest_deg * std::numbers::pi / 180.0);
}

/// The old place that the image shows, if no other resembles it.
std::optional<Recognition> Mapper::old_place(Timestamp t, const PosedImage& posed) const {
  std::vector<bool> wanted;
  for (std::size_t k = 0; k < map_.keyframes().size() && map_.keyframes()[k].t < loop_age(t); ++k)
    wanted.push_back(known().contains(map_.keyframes()[k].t) && may_be_in_view(k, t, posed));
  if (std::ranges::find(wanted, true) == wanted.end()) return std::nullopt;
  const auto is_wanted = [&](std::size_t k) { return k < wanted.size() && wanted[k]; };
  const MapQuery query{posed.image.camera, {}, filter_.keyframes(), is_wanted};
  const Features features = features_of(posed);
  const Recognition found = recognise_features(features, posed, query);
  if (!found.T_M_C || found.agreeing < kLoopInliers) return std::nullopt;
  for (const std::size_t k : found.keyframes) wanted[k] = false;
  const Recognition other = recognise_features(features, posed, query);
  const bool rivals =
      other.T_M_C && static_cast<double>(other.agreeing) >= kLoopRival * static_cast<double>(found.agreeing);
  if (rivals && (other.T_M_C->translation() - found.T_M_C->translation()).norm() > kSecondPlace_m) return std::nullopt;
  return found;
}

/// Where the body is by the old place in that image, if drift explains the difference, and matching by position does
/// not reach that far.
std::optional<Mapper::LoopView> Mapper::loop_view(Timestamp t, std::size_t image, std::span<const PosedImage> images) {
  const PosedImage& posed = images[image];
  const std::optional<Recognition> place = old_place(t, posed);
  if (!place) return std::nullopt;
  LoopView view;
  view.T_O_B = odom_to_map_.T_M_O().inverse() * filter_.T_M_B();
  view.T_M_O = *place->T_M_C * posed.T_O_C.inverse();
  view.drift_m = 0.0;
  double depth = 0.0;
  for (const std::size_t k : place->keyframes) {
    const MapKeyframe& keyframe = map_.keyframes()[k];
    view.drift_m = std::max(view.drift_m, drift_since(keyframe));
    depth = std::max(depth, std::ranges::find(keyframe.views, posed.image.camera, &MapView::camera)->scene_depth);
  }
  const SE3 off = filter_.T_M_B().inverse() * (view.T_M_O * view.T_O_B);
  const double off_m = off.translation().norm(), off_rad = so3::log(off.rotation()).norm();
  if (off_m > view.drift_m || off_rad > kLoopDrift_rad + kLoopDrift_radpm * view.drift_m / kLoopDriftPerPath)
    return std::nullopt;
  if (posed.image.model.mean_focal() * (off_m / depth + off_rad) < config_.search_px) return std::nullopt;
  return projected(view, t, images);
}

/// The view if the points that should then be in the images match, with the pose that they give.
std::optional<Mapper::LoopView> Mapper::projected(LoopView view, Timestamp t, std::span<const PosedImage> images) {
  MapFilter there = filter_at(view.T_M_O, view.T_O_B, t);
  const Search found = search(there, view.T_M_O, images, {known().since, loop_age(t)});
  const std::vector<MapObservation> observations = found.observations();
  if (observations.size() < kLoopInliers) return std::nullopt;
  const std::optional<SE3> T_M_O = there.update(observations, found.candidates.size(), found.T_B_C);
  if (!T_M_O) return std::nullopt;
  std::map<std::uint32_t, int> matches;
  for (const MapObservation& observation : observations) ++matches[observation.keyframe];
  view.keyframe = std::ranges::max_element(matches, {}, [](const auto& each) { return each.second; })->first;
  view.T_M_O = *T_M_O;
  view.T_K_B = there.keyframes()[view.keyframe].inverse() * there.T_M_B();
  return view;
}

/// A loop is closed when images of several positions agree on the place, and the filter believes it. True if T_M_O has
/// been corrected.
bool Mapper::close_loop(Timestamp t, std::span<const PosedImage> images) {
  if (config_.localize_only || (loop_searched_ && to_seconds(t - *loop_searched_) < kLoopInterval_s)) return false;
  loop_searched_ = t;
  std::optional<LoopView> view;
  for (std::size_t image = 0; image < images.size() && !view; ++image) view = loop_view(t, image, images);
  if (!view) return false;
  if (!loop_.empty()) {
    const LoopView& last = loop_.back();
    const double moved_m = (view->T_O_B.translation() - last.T_O_B.translation()).norm();
    const SE3 between = (last.T_M_O * view->T_O_B).inverse() * (view->T_M_O * view->T_O_B);
    const bool agree =
        between.translation().norm() < kLoopAgree_m && so3::log(between.rotation()).norm() < kLoopAgree_rad;
    if (agree && moved_m < kLoopStep_m) return false;
    if (!agree || moved_m > kLoopGap_m) loop_.clear();
  }
  loop_.push_back(*view);
  if (loop_.size() < kLoopViews) return false;
  loop_.clear();
  const auto keyframe = static_cast<std::uint32_t>(view->keyframe);
  filter_.activate(std::span(&keyframe, 1));
  const Matrix6d measured = loop_covariance(kLoopSigma_m, kLoopSigma_rad);
  if (filter_.squared_distance(keyframe, view->T_K_B, measured + loop_covariance(view->drift_m / 3.0, 0.0)) >
      kLoopChiSquare)
    return false;
  odom_to_map_.correct(t, filter_.close(keyframe, view->T_K_B, measured));
  loop_closed_ = t;
  return true;
}

/// Initial values of the final trajectory.
std::optional<TrajectorySmoother::Closed> Mapper::closed() const {
  if (!loop_closed_) return std::nullopt;
  TrajectorySmoother::Closed closed{*loop_closed_, {}};
  for (std::size_t k = 0; k < map_.keyframes().size(); ++k)
    closed.keyframes.emplace(map_.keyframes()[k].number, filter_.keyframes()[k]);
  return closed;
}

}  // namespace edged
