// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapper.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace edged {
namespace {

constexpr double kSearchSigmas = 3.0;
constexpr double kSearchInterval_s = 0.09;  // between images, as long as the place is not known after a loss
constexpr double kLeastSearch_px = 2.0;
constexpr double kSamePlace_m = 0.1, kSamePlace_rad = 0.05;  // of two that are recognised
constexpr double kUnnoticed_s = 2.5;                         // until a loss is said, StatusConfig::lost_after_s
constexpr double kFarthest_m = 0.5, kFarthest_mps = 0.5;     // that dead reckoning may be off
constexpr double kWidest_rad = 0.1, kWidest_radps = 0.01;
constexpr double kRestartPosition_m = 0.1, kRestartYaw_rad = 0.05;
constexpr double kYoungDrift = 5.0;              // of an odometry that has just started, whose scale is still poor
constexpr int kCellsAcross = 6, kCellsDown = 4;  // of an image, to say how much of it the map shows

/// The live features of a camera, and what they look like.
struct Features {
  std::vector<Eigen::Vector2d> pixels, points;
  std::vector<std::optional<Descriptor>> descriptors;
};

Features corners_of(const ChannelView& view, const SE3& T_O_C) {
  Features features;
  for (const Track& track : view.channel->tracker.tracks()) {
    features.pixels.push_back(track.pixel);
    features.points.push_back(track.point);
  }
  const Eigen::Vector3d up_C = T_O_C.R().transpose() * Eigen::Vector3d::UnitZ();
  features.descriptors = describe(view.track, features.pixels, features.points, up_C);
  return features;
}

}  // namespace

Mapper::Mapper(const MapConfig& config)
    : config_(config), map_(config.keyframes), filter_(config.filter), record_(config.filter) {}

void Mapper::restart(const SE3& T_M_O, const NavState& now) {
  const bool first = map_.keyframes().empty() || !known().contains(map_.keyframes().back().t);
  const double position_sigma = first ? 0.0 : kRestartPosition_m, yaw_sigma = first ? 0.0 : kRestartYaw_rad;
  filter_.restart(T_M_O, now.T_W_B, now.t, position_sigma, yaw_sigma);
  record_.restart({now.t, now.T_W_B}, T_M_O, kRestartPosition_m, kRestartYaw_rad);
  started_ = now.t;
  blind_s_ = first ? 0.0 : (searching_ ? blind_s_ : kUnnoticed_s) + to_seconds(now.t - predicted_);
  searching_ = !first;
  T_M_O_guess_ = T_M_O;
  recognised_.reset();
  looks_.clear();
  found_.clear();
}

void Mapper::load(const SavedMap& map) {
  map_ = KeyframeMap(config_.keyframes);
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    MapKeyframe keyframe = map.keyframes[k];
    keyframe.number = k;
    map_.add(std::move(keyframe));
  }
  record_.load(map.T_M_K);
  filter_.load(map.T_M_K, map.covariance);
  if (!map.keyframes.empty()) unlocated_before_ = Timestamp();
}

std::optional<SavedMap> Mapper::save() const {
  if (unlocated_before_) return std::nullopt;
  return SavedMap{{}, map_.keyframes(), filter_.keyframes(), filter_.keyframe_covariance()};
}

void Mapper::predict(const NavState& now) {
  const bool young = blind_s_ > 0.0 && to_seconds(now.t - started_) < config_.keyframes.min_known_s;
  filter_.predict(now.T_W_B, now.t, young ? kYoungDrift : 1.0);
  predicted_ = now.t;
}

Mapper::Search Mapper::search(const MapFilter& filter, const ChannelView& view, const SE3& T_O_C, Period made) {
  const CameraModel& camera = view.channel->tracker.camera();
  Search search;
  search.T_B_C = filter.T_M_B().inverse() * filter.T_M_O() * T_O_C;
  search.candidates = map_.visible({view.channel->camera.name, made, filter.keyframes()}, filter.T_M_O() * T_O_C,
                                   camera, config_.max_observations);
  for (const Candidate& candidate : search.candidates) {
    MapObservation observation{candidate.keyframe, candidate.p_K, candidate.depth_sigma_K,
                               camera.pixel_to_point(candidate.pixel),
                               config_.filter.pixel_sigma / camera.mean_focal()};
    const double stretch = camera.stretch(observation.seen);
    observation.sigma *= stretch;
    const double expected_px =
        kSearchSigmas * camera.mean_focal() / stretch * filter.expected_error(observation, search.T_B_C);
    const double radius = std::clamp(expected_px, kLeastSearch_px, config_.search_px);
    const auto match =
        match_patch(candidate.point->patch, view.track, candidate.pixel, candidate.A, radius, config_.patch);
    search.found.push_back(match.has_value());
    if (!match) continue;
    observation.seen = camera.pixel_to_point(match->pixel);
    search.observations.push_back(observation);
    search.pixels.push_back(match->pixel);
  }
  return search;
}

/// The filter takes what was found, where that agrees.
bool Mapper::update(MapFilter& filter, const Search& search, Timestamp t) {
  const SE3 T_O_B = filter.T_M_O().inverse() * filter.T_M_B();
  if (!filter.update(search.observations, search.candidates.size(), search.T_B_C)) return false;
  for (std::size_t i = 0; i < search.candidates.size(); ++i) map_.note(search.candidates[i], search.found[i], t);
  std::vector<MapObservation> observations = search.observations;
  found_.clear();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const MapKeyframe& keyframe = map_.keyframes()[observations[i].keyframe];
    found_.push_back(
        {keyframe.t, search.pixels[i], filter.keyframes()[observations[i].keyframe] * observations[i].p_K});
    observations[i].keyframe = keyframe.number;
  }
  record_.add_observations({t, T_O_B}, search.T_B_C, observations, filter.T_M_O());
  return true;
}

bool Mapper::localize(Timestamp t, const ChannelView& view, const SE3& T_O_B) {
  // In a map of another run no dead reckoning tells right from wrong: two looks that agree must be further apart.
  const double interval_s = searching_ && !unlocated_before_ ? kSearchInterval_s : config_.min_interval_s;
  if (looked_at_ && to_seconds(t - *looked_at_) < interval_s) return false;
  looked_at_ = t;
  found_.clear();
  const SE3 T_O_C = view.channel->T_W_C(T_O_B);
  const Period old_enough{known().since, t - duration_from_seconds(config_.keyframes.min_age_s)};
  const Search here = search(filter_, view, T_O_C, old_enough);
  const auto older = std::ranges::count_if(here.observations, [&](const MapObservation& observation) {
    return map_.keyframes()[observation.keyframe].t < started_;
  });
  const bool agreed = update(filter_, here, t);
  if (!searching_ && !unlocated_before_) return false;
  const bool found_by_guess = searching_ && agreed && older >= config_.filter.min_observations;
  const bool found_by_looks = (unlocated_before_ || !found_by_guess) && recognise(t, view, T_O_C);
  if (found_by_looks) unlocated_before_.reset();
  if (found_by_guess || found_by_looks) searching_ = false;
  return found_by_guess || found_by_looks;
}

/// Whether dead reckoning may have been so far off. Its heading is the gyro's, and good: of places that look alike most
/// are refused by that.
bool Mapper::plausible(const SE3& T_M_O, const SE3& T_O_B) const {
  const SE3 off = (T_M_O_guess_ * T_O_B).inverse() * (T_M_O * T_O_B);
  return off.translation().norm() < kFarthest_m + kFarthest_mps * blind_s_ &&
         so3::log(off.rotation()).norm() < kWidest_rad + kWidest_radps * blind_s_;
}

/// By looks alone, of what was there before the newest start, or of the map that was taken up. Two images must agree on
/// where that is, and the points that should then be in view be found. What has been mapped since, from a guess, goes.
bool Mapper::recognise(Timestamp t, const ChannelView& view, const SE3& T_O_C) {
  const Features features = corners_of(view, T_O_C);
  const double focal = view.channel->tracker.camera().mean_focal();
  const Period before{Timestamp::min(), unlocated_before_.value_or(started_)};
  const std::optional<SE3> T_M_C = map_.recognise({view.channel->camera.name, before, filter_.keyframes()},
                                                  features.descriptors, features.points, T_O_C.rotation(), focal);
  const std::optional<SE3> last = std::exchange(recognised_, std::nullopt);
  if (!T_M_C) return false;
  const SE3 T_M_O = *T_M_C * T_O_C.inverse(), T_O_B = filter_.T_M_O().inverse() * filter_.T_M_B();
  if (!unlocated_before_ && !plausible(T_M_O, T_O_B)) return false;
  recognised_ = T_M_O;
  if (!last) return false;
  const SE3 between = (*last * T_O_B).inverse() * (T_M_O * T_O_B);
  if (between.translation().norm() > kSamePlace_m || so3::log(between.rotation()).norm() > kSamePlace_rad) return false;
  MapFilter there = filter_;
  there.restart(T_M_O, T_O_B, t, kSamePlace_m, kSamePlace_rad);
  if (!update(there, search(there, view, T_O_C, before), t)) return false;
  record_.forget_guess();
  if (unlocated_before_) record_.move_before(T_M_O * filter_.T_M_O().inverse());
  filter_ = std::move(there);
  while (map_.keyframes().back().t >= before.before) remove_keyframe(map_.keyframes().size() - 1);
  return true;
}

double Mapper::covered_share(const FeatureTracker& tracker) const {
  const CameraModel& camera = tracker.camera();
  const auto cell = [&](const Eigen::Vector2d& pixel) {
    return std::pair(static_cast<int>(pixel.x() * kCellsAcross / camera.width()),
                     static_cast<int>(pixel.y() * kCellsDown / camera.height()));
  };
  std::set<std::pair<int, int>> textured, shown;
  for (const Track& track : tracker.tracks()) textured.insert(cell(track.pixel));
  for (const MapMatch& point : found_) {
    if (textured.contains(cell(point.pixel))) shown.insert(cell(point.pixel));
  }
  return textured.empty() ? 1.0 : static_cast<double>(shown.size()) / static_cast<double>(textured.size());
}

void Mapper::keyframe(Timestamp t, const ChannelView& view, const SE3& T_O_B) {
  const FeatureTracker& tracker = view.channel->tracker;
  if (to_seconds(t - started_) < config_.keyframes.min_known_s) return;
  if (!map_.wants(covered_share(tracker))) return;
  Look look{t, view.channel->camera.name, {}};
  const Features features = corners_of(view, view.channel->T_W_C(T_O_B));
  for (std::size_t i = 0; i < features.pixels.size(); ++i) {
    if (const auto patch = cut_patch(view.track, features.pixels[i]))
      look.features[tracker.tracks()[i].id] = {*patch, features.descriptors[i], features.pixels[i]};
  }
  looks_.push_back(std::move(look));
}

void Mapper::take(const KeyframeRecord& record) {
  record_.refine({record.t, record.T_W_B});
  while (!looks_.empty() && looks_.front().t < record.t) looks_.pop_front();
  if (looks_.empty() || looks_.front().t != record.t) return;
  const Look& look = looks_.front();
  const auto view = std::ranges::find(record.views, look.camera, &KeyframeView::camera);
  MapKeyframe keyframe{record.t, record.t, look.camera, view->T_B_C, {}};
  for (const KeyframePoint& point : view->points) {
    const auto feature = look.features.find(point.id);
    if (feature == look.features.end()) continue;
    keyframe.points.push_back({point.point, point.inverse_depth, point.sigma, feature->second.patch,
                               feature->second.descriptor, feature->second.pixel, 0, 0});
  }
  if (!map_.gains_by(keyframe)) return;
  keyframe.number = record_.add_keyframe({record.t, record.T_W_B});
  map_.add(std::move(keyframe));
  filter_.add_keyframe(record.T_W_B, record.t);
  if (const auto superfluous = map_.superfluous(known())) remove_keyframe(*superfluous);
}

void Mapper::remove_keyframe(std::size_t keyframe) {
  map_.remove(keyframe);
  filter_.remove_keyframe(keyframe);
}

FinalTrajectory Mapper::final_trajectory() const {
  TrajectorySmoother::Path path = record_.path();
  FinalTrajectory known{std::move(path.poses), {}};
  for (const MapKeyframe& keyframe : map_.keyframes()) {
    known.keyframes.push_back(mapped(keyframe, path.keyframes[keyframe.number]));
  }
  return known;
}

}  // namespace edged
