// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/mapper.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "edged/core/directions.hpp"
#include "edged/core/statistics.hpp"
#include "edged/map/tuning.hpp"
#include "edged/pipeline/mapping/final_optimization.hpp"

namespace edged {
namespace {

/// Replaces the points by those that the window has estimated.
void place_points(MapView& view, const KeyframeView& estimated) {
  view.T_B_C = estimated.T_B_C;
  std::vector<MapPoint> points;
  for (const KeyframePoint& placed : estimated.points) {
    const auto known = std::ranges::find(view.points, placed.id, &MapPoint::id);
    if (known == view.points.end()) continue;
    MapPoint& point = points.emplace_back(*known);
    point.point = placed.point;
    point.inverse_depth = placed.inverse_depth;
    point.sigma = placed.sigma;
  }
  view.points = std::move(points);
}

}  // namespace

Mapper::Mapper(const MapConfig& config, double lost_after_s)
    : config_(config),
      lost_after_s_(lost_after_s),
      map_(config.keyframes),
      filter_(config.filter, config.localize_only),
      loops_(config) {}

void Mapper::restart(const SE3& T_new_old, const OdomState& now, double tilt_sigma) {
  odom_to_map_.restart(T_new_old, now);
  begin_start(now, tilt_sigma);
}

void Mapper::reset_uncertainty(const OdomState& now, double gap_s) {
  odom_to_map_.restart(now.t);
  begin_start(now, filter_.tilt_sigma(), gap_s);
}

void Mapper::begin_start(const OdomState& now, double tilt_sigma, double gap_s) {
  const bool first = map_.keyframes().empty() || !localized_period().contains(map_.keyframes().back().t);
  const double position_sigma = first ? 0.0 : kMapTuning.same_place_m,
               yaw_sigma = first ? 0.0 : kMapTuning.same_place_rad;
  T_M_O_dead_reckoning_ = odom_to_map_.T_M_O();
  filter_.restart(T_M_O_dead_reckoning_, now.T_O_B, now.t, position_sigma, yaw_sigma, tilt_sigma);
  if (record_.empty()) last_match_ = now.t;
  record_.restart({now.t, now.T_O_B}, kMapTuning.same_place_m, kMapTuning.same_place_rad);
  started_ = now.t;
  dead_reckoning_s_ =
      first ? 0.0 : (relocalizing_ ? dead_reckoning_s_ : lost_after_s_) + to_seconds(now.t - predicted_);
  gap_s_ = (relocalizing_ ? gap_s_ : 0.0) + gap_s;
  relocalizing_ = !first;
  relocalization_candidates_.clear();
  loops_.reset();
  p_O_B_ = now.T_O_B.translation();
  in_window_.clear();
  young_.clear();
  matches_.clear();
}

void Mapper::begin_epoch() {
  FinalTrajectory previous = final_trajectory();
  OdomToMap odom_to_map = std::move(odom_to_map_);
  odom_to_map.clear_history();
  const std::optional<SavedMap> fixed = config_.localize_only ? save() : std::nullopt;
  *this = Mapper(config_, lost_after_s_);
  previous_trajectory_ = std::move(previous);
  odom_to_map_ = std::move(odom_to_map);
  if (fixed) load(*fixed);
}

void Mapper::load(const SavedMap& map) {
  map_ = KeyframeMap(config_.keyframes);
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    MapKeyframe keyframe = map.keyframes[k];
    keyframe.number = k;
    map_.add(std::move(keyframe));
  }
  record_.load(map.T_M_K, config_.localize_only);
  filter_.load(map.T_M_K, map.covariance, map.inactive);
  if (config_.localize_only) fixed_ = SavedMap{{}, {}, {}, map.covariance, map.inactive};
  if (!map.keyframes.empty()) loaded_map_until_ = Timestamp();
}

std::optional<SavedMap> Mapper::save() const {
  if (loaded_map_until_ && !config_.localize_only) return std::nullopt;
  SavedMap now{{}, map_.keyframes(), filter_.keyframes(), filter_.keyframe_covariance(), filter_.inactive()};
  if (fixed_) now.covariance = fixed_->covariance, now.inactive = fixed_->inactive;
  return now;
}

void Mapper::predict(const OdomState& now, Motion motion, const std::optional<OdomUncertainty>& known) {
  const bool at_rest = motion != Motion::Any;
  if (known) drift_ = drift_of(*known);
  filter_.predict(odom_to_map_.T_M_O(), now.T_O_B, now.t, motion == Motion::None ? Drift{} : drift_);
  if (known) filter_.set_tilt_sigma(known->tilt);
  predicted_ = now.t;
  if (at_rest) last_match_ = now.t;
  if (!at_rest) path_m_ += (now.T_O_B.translation() - p_O_B_).norm();
  p_O_B_ = now.T_O_B.translation();
  if (!config_.localize_only || loaded_map_until_ || unmatched_s() <= kMapTuning.max_unmatched_s) return;
  loaded_map_until_ = Timestamp();
  reset_uncertainty(now);
}

/// The filter takes the matches if they agree, and corrects T_M_O.
bool Mapper::update(MapFilter& filter, const SE3& T_M_O, const MapSearch& search, Timestamp t,
                    std::span<const PosedImage> images) {
  const SE3 T_O_B = T_M_O.inverse() * filter.T_M_B();
  std::vector<MapObservation> observations = search.observations();
  const std::optional<SE3> corrected = filter.update(observations, search.candidates.size(), search.T_B_C);
  if (!corrected) return false;
  odom_to_map_.correct(t, *corrected);
  last_match_ = t;
  T_M_B_matched_ = filter.T_M_B();
  matches_.clear();
  for (const Candidate& candidate : search.candidates) {
    if (!config_.localize_only) map_.record_search(candidate, t);
    if (!candidate.matched) continue;
    const MapObservation& observation = candidate.observation;
    matches_.push_back({map_.keyframes()[observation.keyframe].t, candidate.pixel,
                        filter.keyframes()[observation.keyframe] * observation.p_K,
                        images[observation.camera].image.camera});
  }
  for (MapObservation& observation : observations)
    observation.keyframe = static_cast<std::uint32_t>(map_.keyframes()[observation.keyframe].number);
  record_.add_observations({t, T_O_B}, search.T_B_C, observations);
  return true;
}

/// The matched points are seen in about the same directions as at the last match: their errors would be the same, too.
bool Mapper::same_view(double focal_px) const {
  if (relocalizing_ || loaded_map_until_ || matches_.empty()) return false;
  const SE3 T_before_M = T_M_B_matched_.inverse(), T_B_M = filter_.T_M_B().inverse();
  std::vector<double> moved_px;
  for (const MapMatch& match : matches_)
    moved_px.push_back(focal_px * angle_between(T_before_M * match.p_W, T_B_M * match.p_W));
  return median(std::move(moved_px)) < kMapTuning.new_view_px;
}

bool Mapper::localize(Timestamp t, std::span<const PosedImage> images, double place_sigma) {
  // In a map of another run no dead reckoning rejects wrong places: two instants that agree must be further apart.
  const double interval_s =
      relocalizing_ && !loaded_map_until_ ? kMapTuning.relocalization_interval_s : config_.min_interval_s;
  if (last_search_ && to_seconds(t - *last_search_) < interval_s) return false;
  if (same_view(images.front().image.model.mean_focal())) {
    last_match_ = t;
    return false;
  }
  last_search_ = t;
  matches_.clear();
  // Far from where dead reckoning has them, older points match by chance.
  const bool misplaced = relocalizing_ && place_sigma > kMapTuning.gate_sigmas * kMapTuning.same_place_m;
  const TimeInterval old_enough{misplaced ? started_ : localized_period().since,
                                t - duration_from_seconds(config_.keyframes.min_age_s)};
  const SE3 T_M_O = odom_to_map_.T_M_O();
  const MapSearch here = search_map(map_, filter_, config_, T_M_O, images, old_enough);
  const std::ptrdiff_t older = here.matched_before(map_, started_);
  const bool agreed = update(filter_, T_M_O, here, t, images);
  if (relocalizing_ || loaded_map_until_)
    return relocalize(t, images, agreed && older >= config_.filter.min_observations);
  if (agreed && !loops_.loop_needed(here, map_, t)) {
    loops_.reset();
  } else if (close_loop(t, images)) {
    const SE3 closed = odom_to_map_.T_M_O();
    update(filter_, closed, search_map(map_, filter_, config_, closed, images, old_enough), t, images);
  }
  return false;
}

/// matches_older: points of keyframes before the newest start match where dead reckoning has them.
bool Mapper::relocalize(Timestamp t, std::span<const PosedImage> images, bool matches_older) {
  const bool by_dead_reckoning = relocalizing_ && matches_older;
  const bool by_appearance = (loaded_map_until_ || !by_dead_reckoning) && relocalize_by_appearance(t, images);
  if (by_appearance) loaded_map_until_.reset();
  if (by_dead_reckoning || by_appearance) relocalizing_ = false;
  return by_dead_reckoning || by_appearance;
}

/// Whether dead reckoning can be that far off. Its heading is that of the gyro, and accurate, which rejects most
/// similar places.
bool Mapper::plausible(const SE3& T_M_O, const SE3& T_O_B) const {
  const SE3 off = (T_M_O_dead_reckoning_ * T_O_B).inverse() * (T_M_O * T_O_B);
  const double seconds = dead_reckoning_s_;
  return off.translation().norm() <
             kMapTuning.dead_reckoning_m + kMapTuning.dead_reckoning_mps * seconds + kMapTuning.gap_mps * gap_s_ &&
         so3::log(off.rotation()).norm() <
             kMapTuning.max_turn_rad + kMapTuning.dead_reckoning_radps * seconds + kMapTuning.gap_radps * gap_s_;
}

/// T_M_O by place recognition, from keyframes of that time.
std::optional<SE3> Mapper::recognized_T_M_O(const PosedImage& posed, TimeInterval created) const {
  const SE3& T_O_C = posed.T_O_C;
  const std::optional<SE3> T_M_C =
      recognize_place(map_, {posed.image.camera, created, filter_.keyframes()}, features_of(posed), posed).T_M_C;
  return T_M_C ? std::optional(*T_M_C * T_O_C.inverse()) : std::nullopt;
}

/// Relocalization by place recognition, in the keyframes before the newest start or in the loaded map. The images of
/// two instants must agree on the pose: two cameras of one instant may both take a similar place for this one.
bool Mapper::relocalize_by_appearance(Timestamp t, std::span<const PosedImage> images) {
  const TimeInterval before{Timestamp::min(), loaded_map_until_.value_or(started_)};
  const SE3 T_O_B = odom_to_map_.T_M_O().inverse() * filter_.T_M_B();
  const std::vector<SE3> last = std::exchange(relocalization_candidates_, {});
  for (const PosedImage& posed : images) {
    const std::optional<SE3> T_M_O = recognized_T_M_O(posed, before);
    if (T_M_O && (loaded_map_until_ || plausible(*T_M_O, T_O_B))) relocalization_candidates_.push_back(*T_M_O);
  }
  const auto agrees = [&](const SE3& T_M_O, const SE3& other) {
    const SE3 between = (other * T_O_B).inverse() * (T_M_O * T_O_B);
    return between.translation().norm() <= kMapTuning.same_place_m &&
           so3::log(between.rotation()).norm() <= kMapTuning.same_place_rad;
  };
  return std::ranges::any_of(relocalization_candidates_, [&](const SE3& T_M_O) {
    return std::ranges::any_of(last, [&](const SE3& other) { return agrees(T_M_O, other); }) &&
           confirmed(T_M_O, t, images, before);
  });
}

/// Whether the points that should then be in view match. Keyframes mapped since, at uncertain poses, are removed.
bool Mapper::confirmed(const SE3& T_M_O, Timestamp t, std::span<const PosedImage> images, TimeInterval created) {
  const SE3 T_M_O_so_far = odom_to_map_.T_M_O(), T_O_B = T_M_O_so_far.inverse() * filter_.T_M_B();
  MapFilter there = filter_at(filter_, T_M_O, T_O_B, t);
  if (!update(there, T_M_O, search_map(map_, there, config_, T_M_O, images, created), t, images)) return false;
  odom_to_map_.drop_dead_reckoning();
  // Where the map never changes, all poses so far were published in its frame.
  if (loaded_map_until_ && !config_.localize_only) odom_to_map_.transform_earlier(T_M_O * T_M_O_so_far.inverse());
  filter_ = std::move(there);
  while (map_.keyframes().back().t >= created.before) remove_keyframe(map_.keyframes().size() - 1);
  return true;
}

/// True if T_M_O has been corrected.
bool Mapper::close_loop(Timestamp t, std::span<const PosedImage> images) {
  if (config_.localize_only) return false;
  const std::optional<Loop> loop =
      loops_.find({t, map_, filter_, odom_to_map_.T_M_O(), path_m_, localized_period().since}, images);
  if (!loop) return false;
  const SE3 before = filter_.T_M_B();
  const std::optional<SE3> T_M_O = LoopCloser::close(filter_, map_, path_m_, *loop);
  if (!T_M_O) return false;
  const SE3 off = before.inverse() * filter_.T_M_B();
  closed_loop_ = {t, {map_.keyframes()[loop->keyframe].t, off.translation().norm(), so3::log(off.rotation()).norm()}};
  odom_to_map_.correct(t, *T_M_O);
  return true;
}

/// Initial values of the final trajectory.
std::optional<TrajectorySmoother::Closed> Mapper::closed() const {
  if (!closed_loop_) return std::nullopt;
  TrajectorySmoother::Closed closed{closed_loop_->t, {}};
  for (std::size_t k = 0; k < map_.keyframes().size(); ++k)
    closed.keyframes.emplace(map_.keyframes()[k].number, filter_.keyframes()[k]);
  return closed;
}

/// The share of all cells with features in which the map has points, in any of the images.
double Mapper::covered_share(std::span<const PosedImage> images) const {
  std::set<std::tuple<std::string_view, int, int>> textured, shown;
  for (const PosedImage& posed : images) {
    const TrackedImage& image = posed.image;
    const auto cell = [&](const Eigen::Vector2d& pixel) {
      return std::tuple(std::string_view(image.camera),
                        static_cast<int>(pixel.x() * kMapTuning.coverage_columns / image.model.width()),
                        static_cast<int>(pixel.y() * kMapTuning.coverage_rows / image.model.height()));
    };
    for (const Track& track : image.tracks) textured.insert(cell(track.pixel));
    for (const MapMatch& point : matches_) {
      if (point.camera == image.camera && textured.contains(cell(point.pixel))) shown.insert(cell(point.pixel));
    }
  }
  return textured.empty() ? 1.0 : static_cast<double>(shown.size()) / static_cast<double>(textured.size());
}

void Mapper::keyframe(Timestamp t, std::span<const PosedImage> images) {
  if (config_.localize_only || (is_young(t) && !map_.keyframes().empty())) return;
  if (!map_.needs_keyframe(covered_share(images))) return;
  MapKeyframe& keyframe = in_window_.emplace_back(MapKeyframe{t, t, {}});
  keyframe.path_m = path_m_;
  for (const PosedImage& posed : images) {
    const TrackedImage& image = posed.image;
    MapView& view = keyframe.views.emplace_back(MapView{image.camera, SE3(), {}});
    const std::vector<std::optional<Descriptor>> descriptors = features_of(posed).descriptors;
    for (std::size_t i = 0; i < image.tracks.size(); ++i) {
      const Track& track = image.tracks[i];
      if (const auto patch = cut_patch(image.image, {track.pixel}))
        view.points.push_back({.id = track.id, .patch = *patch, .descriptor = descriptors[i], .pixel = track.pixel});
    }
  }
}

void Mapper::add_keyframe(const MarginalizedKeyframe& record, bool last_chance) {
  if (last_chance)
    for (auto& [keyframe, T_O_B] : std::exchange(young_, {})) insert(keyframe, T_O_B);
  record_.refine({record.t, record.T_O_B});
  while (!in_window_.empty() && in_window_.front().t < record.t) in_window_.pop_front();
  if (in_window_.empty() || in_window_.front().t != record.t) return;
  MapKeyframe keyframe = std::move(in_window_.front());
  in_window_.pop_front();
  for (MapView& view : keyframe.views)
    place_points(view, *std::ranges::find(record.views, view.camera, &KeyframeView::camera));
  if (is_young(record.t) && !last_chance)
    young_.emplace_back(std::move(keyframe), record.T_O_B);
  else if (insert(keyframe, record.T_O_B))
    young_.clear();
}

/// If it is worth it.
bool Mapper::insert(MapKeyframe& keyframe, const SE3& T_O_B) {
  if (!map_.prune_points(keyframe)) return false;
  const Timestamp t = keyframe.t;
  keyframe.number = record_.add_keyframe({t, T_O_B});
  map_.add(std::move(keyframe));
  filter_.add_keyframe(odom_to_map_.T_M_O(), T_O_B, t);
  if (const auto redundant = map_.redundant_keyframe(localized_period())) remove_keyframe(*redundant);
  return true;
}

void Mapper::remove_keyframe(std::size_t keyframe) {
  map_.remove(keyframe);
  filter_.remove_keyframe(keyframe);
}

void Mapper::end_start(StartRecord start) {
  if (!start.empty()) starts_.push_back(std::move(start));
}

FinalTrajectory Mapper::final_trajectory(StartRecord present, const OptimizationProgress& progress) const {
  FinalTrajectory all = previous_trajectory_;
  TrajectorySmoother::Solution solution = record_.solve(odom_to_map_, closed());
  std::vector<StartRecord> starts = starts_;
  if (!present.empty()) starts.push_back(std::move(present));
  FinalCost cost;
  const Trajectory placed = optimize_jointly(record_, std::move(starts), solution, cost, progress);
  const Trajectory path = record_.path(odom_to_map_, solution, placed);
  all.initial_cost += cost.before;
  all.final_cost += cost.after;
  all.poses.insert(all.poses.end(), path.begin(), path.end());
  for (const MapKeyframe& keyframe : map_.keyframes())
    all.keyframes.push_back(mapped(keyframe, solution.keyframes[keyframe.number]));
  return all;
}

}  // namespace edged
