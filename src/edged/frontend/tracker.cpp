// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tracks features through the images of one camera.
#include "edged/frontend/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/camera/two_view.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

cv::Point2f to_cv(const Eigen::Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }
Eigen::Vector2d to_eigen(const cv::Point2f& p) { return {p.x, p.y}; }

float distance(const cv::Point2f& a, const cv::Point2f& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// 255 where the detector of this camera must not place corners.
cv::Mat unused_pixels(const CameraModel& camera, int border_px) {
  if (!camera.view_limit() && !camera.is_masked()) return {};
  cv::Mat unused(camera.height(), camera.width(), CV_8UC1);
  for (int y = 0; y < unused.rows; ++y)
    for (int x = 0; x < unused.cols; ++x)
      unused.at<uchar>(y, x) = camera.contains({static_cast<double>(x), static_cast<double>(y)}, border_px) ? 0 : 255;
  return unused;
}

template <typename T>
std::vector<T> select(const std::vector<T>& values, const std::vector<std::size_t>& indices) {
  std::vector<T> selected;
  selected.reserve(indices.size());
  for (const std::size_t i : indices) selected.push_back(values[i]);
  return selected;
}

}  // namespace

void ReferencePatchConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled,
             {.effect = "Align features to their reference patches, which removes the drift of optical flow."});
  patch.visit(fields);
}

void TrackerConfig::visit(ConfigFields& fields) {
  fields.group("detector", detector);
  fields.group("klt", klt);
  fields.group("outliers", outliers);
  fields.group("templates", reference_patches);
  fields.add("forward_backward_px", forward_backward_px,
             {"px", 0.01, 100, "A track that is followed backwards must return this close to its start."});
  fields.add("min_correlation", min_correlation,
             {"1", -1, 1, "Least correlation of a track's patch with the one in the previous image."});
  fields.add("sigma_px", sigma_px, {"px", 0.01, 20, "Standard deviation of an observation in the estimator."});
}

FeatureTracker::FeatureTracker(std::string camera_name, const CameraModel& camera, const TrackerConfig& config)
    : name_(std::move(camera_name)),
      camera_(camera),
      config_(config),
      unused_(unused_pixels(camera, config.detector.border_px)),
      reference_patches_(camera, config.reference_patches.patch) {
  EDGED_CHECK(camera.width() > 0 && camera.height() > 0, "camera {} has no size", name_);
  if (config.klt.window_px % 2 == 0) {
    throw InputError::format("klt.window_px = {} must be odd, e.g. {}", config.klt.window_px, config.klt.window_px + 1);
  }
}

TrackSummary FeatureTracker::track(const cv::Mat& image, Timestamp t,
                                   const std::optional<TrackPrediction>& prediction) {
  TrackSummary summary;
  summary.before = static_cast<int>(tracks_.size());
  now_ = t;
  if (image.empty()) {
    reset();
    return summary;
  }
  check_image(image);
  current_.build(image, config_.klt);
  increments_ = prediction ? prediction->increments : BrightnessIncrements();
  if (prediction && prediction->reference_patches) {
    reference_patches_.move(prediction->T_cur_prev);
  } else {
    reference_patches_.clear();
  }
  if (!tracks_.empty()) {
    Matches matches = match_all(prediction, summary);
    merge(matches);
    apply(matches, summary);
  }
  std::swap(previous_, current_);
  return summary;
}

OutlierResult FeatureTracker::reject_outliers(Reference reference, const std::optional<Eigen::Matrix3d>& R_ref_cur) {
  std::vector<Correspondence> pairs;
  std::vector<std::size_t> owners;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Track& track = tracks_[i];
    if (reference == Reference::Keyframe ? !track.in_keyframe : track.age == 0) continue;
    pairs.push_back({reference == Reference::Keyframe ? track.keyframe_point : track.previous_point, track.point});
    owners.push_back(i);
  }
  OutlierResult result = find_inliers(pairs, R_ref_cur, camera_.mean_focal(), config_.outliers);
  std::vector<FeatureId> outliers;
  for (std::size_t k = 0; k < owners.size(); ++k) {
    if (!result.inlier[k]) outliers.push_back(tracks_[owners[k]].id);
  }
  remove(outliers);
  return result;
}

Track FeatureTracker::first_track(FeatureId id, const Eigen::Vector2d& pixel) const {
  Track track;
  track.id = id;
  track.pixel = track.previous_pixel = pixel;
  track.point = track.previous_point = camera_.pixel_to_point(pixel);
  track.first_seen = now_;
  return track;
}

int FeatureTracker::detect(const cv::Mat& image, FeatureId& next_id, int most) {
  if (image.empty()) return 0;
  check_image(image);
  std::vector<Eigen::Vector2d> occupied;
  for (const Track& track : tracks_) occupied.push_back(track.pixel);
  const int limit = std::min(most, config_.detector.max_features) - static_cast<int>(tracks_.size());
  if (limit <= 0) return 0;
  const std::vector<Corner> corners = detect_corners(image, occupied, limit, config_.detector, unused_);
  for (const Corner& corner : corners) {
    tracks_.push_back(first_track(next_id++, corner.pixel));
  }
  return static_cast<int>(corners.size());
}

const Track* FeatureTracker::find(FeatureId id) const {
  const auto track = std::ranges::lower_bound(tracks_, id, {}, &Track::id);
  return track != tracks_.end() && track->id == id ? &*track : nullptr;
}

void FeatureTracker::add_feature(FeatureId id, const Eigen::Vector2d& pixel) {
  std::erase_if(tracks_, [&](const Track& track) { return (track.pixel - pixel).norm() < config_.merge_px; });
  const auto next = std::ranges::lower_bound(tracks_, id, {}, &Track::id);
  EDGED_CHECK(next == tracks_.end() || next->id != id, "camera {} follows feature {} already", name_, id);
  tracks_.insert(next, first_track(id, pixel));
}

bool FeatureTracker::needs_detection() const {
  return static_cast<double>(tracks_.size()) < kFrontendTuning.refill_share * config_.detector.max_features;
}

void FeatureTracker::mark_keyframe() {
  for (Track& track : tracks_) {
    track.keyframe_pixel = track.pixel;
    track.keyframe_point = track.point;
    track.in_keyframe = true;
  }
  keyframe_tracks_ = static_cast<int>(tracks_.size());
  if (config_.reference_patches.enabled) reference_patches_.extract({previous_.image(), increments_}, tracks_);
}

KeyframeTracks FeatureTracker::since_keyframe(const Eigen::Matrix3d& R_kf_cur) const {
  KeyframeTracks result{keyframe_tracks_, {}};
  for (const Track& track : tracks_) {
    if (track.in_keyframe) result.parallax_rad.push_back(ray_angle(track.keyframe_point, R_kf_cur, track.point));
  }
  return result;
}

void FeatureTracker::remove(std::span<const FeatureId> ids) {
  std::erase_if(tracks_, [&](const Track& track) { return std::find(ids.begin(), ids.end(), track.id) != ids.end(); });
}

void FeatureTracker::reset() {
  tracks_.clear();
  previous_.clear();
  reference_patches_.clear();
  keyframe_tracks_ = 0;
}

CameraObservations FeatureTracker::observations() const {
  CameraObservations result{name_, {}};
  result.features.reserve(tracks_.size());
  const double sigma = config_.sigma_px / camera_.mean_focal();
  for (const Track& track : tracks_)
    result.features.push_back({track.id, track.point, sigma * camera_.stretch(track.point)});
  return result;
}

void FeatureTracker::check_image(const cv::Mat& image) const {
  if (image.type() != CV_8UC1 || image.cols != camera_.width() || image.rows != camera_.height()) {
    throw InputError::format("an image of camera {} is {}x{} with {} channels, its calibration is for {}x{} grey: {}",
                             name_, image.cols, image.rows, image.channels(), camera_.width(), camera_.height(),
                             "use the calibration of this camera");
  }
}

/// The expected position of each track in the new image's camera [m].
std::vector<Eigen::Vector3d> FeatureTracker::expected(const TrackPrediction& prediction) const {
  std::vector<Eigen::Vector3d> points;
  points.reserve(tracks_.size());
  for (const Track& track : tracks_) {
    const std::optional<double> own = prediction.depth ? prediction.depth(track.id) : std::nullopt;
    points.emplace_back(prediction.T_cur_prev * (own.value_or(prediction.scene_depth) * track.point.homogeneous()));
  }
  return points;
}

std::vector<cv::Point2f> FeatureTracker::projected(const std::vector<Eigen::Vector3d>& points_C,
                                                   const Eigen::Vector2d& offset_px) const {
  std::vector<cv::Point2f> seeds;
  seeds.reserve(points_C.size());
  for (const Eigen::Vector3d& p_C : points_C) {
    const std::optional<Eigen::Vector2d> pixel = camera_.project(p_C);
    // A position far outside marks a point behind the camera; match() ends such tracks at the border.
    seeds.push_back(pixel ? to_cv(*pixel + offset_px) : cv::Point2f(-1e6F, -1e6F));
  }
  return seeds;
}

FeatureMotion FeatureTracker::motion_of(const Track& track, std::size_t i, const Matches& matches) {
  const Eigen::Vector2d pixel = to_eigen(matches.points[i]);
  return {pixel, pixel - track.pixel, matches.expected_C[i]};
}

FeatureTracker::Matches FeatureTracker::match(const std::vector<cv::Point2f>& from,
                                              const std::vector<cv::Point2f>& seeds,
                                              std::vector<Eigen::Vector3d> expected_C) const {
  Matches matches{seeds, std::vector<char>(from.size(), 0), std::vector<char>(from.size(), 0), std::move(expected_C)};
  // On event frames the predicted position is a better start of the alignment than that of the optical flow, which
  // follows the appearance of an edge under the motion.
  const bool on_events = !increments_.image.empty();
  std::vector<std::size_t> unaligned;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (!camera_.contains(to_eigen(seeds[i]))) continue;  // NaN, too
    if (!on_events || !align(i, matches)) unaligned.push_back(i);
  }
  const bool aligned_later = !matches.expected_C.empty() && !reference_patches_.empty();
  const Flow forward = follow(
      previous_, current_, select(from, unaligned), select(seeds, unaligned),
      aligned_later ? std::min(kFrontendTuning.predicted_top_level, config_.klt.levels - 1) : config_.klt.levels - 1,
      config_.klt, aligned_later ? kFrontendTuning.coarse_flow_step_px : kFrontendTuning.flow_step_px);
  std::vector<std::size_t> otherwise;  // matches, or has no reference patch
  for (std::size_t k = 0; k < unaligned.size(); ++k) {
    const std::size_t i = unaligned[k];
    matches.points[i] = forward.points[k];
    const bool inside = camera_.contains(to_eigen(forward.points[k]), kFrontendTuning.border_px);
    matches.kept[i] = inside && forward.found[k];
    if (matches.kept[i] && !align(i, matches)) otherwise.push_back(i);
  }
  match_back(from, otherwise, matches);
  return matches;
}

/// To the reference patch of the track, near the present match. False if it does not match there.
bool FeatureTracker::align(std::size_t i, Matches& matches) const {
  if (matches.expected_C.empty()) return false;
  const std::optional<Eigen::Vector2d> aligned =
      reference_patches_.align(tracks_[i].id, {current_.image(), increments_}, motion_of(tracks_[i], i, matches));
  if (!aligned || !camera_.contains(*aligned, kFrontendTuning.border_px)) return false;
  matches.points[i] = to_cv(*aligned);
  matches.kept[i] = 1;
  matches.matches_reference[i] = 1;
  return true;
}

/// Tracks that no reference patch confirms must pass the forward-backward check and the correlation with the last
/// image.
void FeatureTracker::match_back(const std::vector<cv::Point2f>& from, const std::vector<std::size_t>& which,
                                Matches& matches) const {
  const Flow backward = follow(current_, previous_, select(matches.points, which), select(from, which),
                               kFrontendTuning.predicted_top_level, config_.klt);
  for (std::size_t k = 0; k < which.size(); ++k) {
    const std::size_t i = which[k];
    matches.kept[i] =
        backward.found[k] && distance(backward.points[k], from[i]) <= config_.forward_backward_px &&
        patch_correlation(previous_.image(), from[i], current_.image(), matches.points[i]) >= config_.min_correlation;
  }
}

FeatureTracker::Matches FeatureTracker::match_all(const std::optional<TrackPrediction>& prediction,
                                                  TrackSummary& summary) const {
  std::vector<cv::Point2f> from;
  for (const Track& track : tracks_) from.push_back(to_cv(track.pixel));
  if (!prediction) return match(from, from, {});

  std::vector<Eigen::Vector3d> expected_C = expected(*prediction);
  const std::vector<cv::Point2f> seeds = projected(expected_C, prediction->offset_px);
  Matches matches = match(from, seeds, std::move(expected_C));
  const auto kept = [](const Matches& m) { return std::ranges::count(m.kept, 1); };
  const auto all = static_cast<double>(from.size());
  if (all - static_cast<double>(kept(matches)) > kFrontendTuning.retry_share * all) {
    // The few tracks that survive a bad prediction are likely wrong, and so is its warp: all are tracked again without
    // it.
    Matches again = match(from, from, {});
    summary.prediction_failed = kept(again) > kept(matches);
    if (summary.prediction_failed) return again;
  }
  std::vector<double> dx, dy;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!matches.kept[i]) continue;
    dx.push_back(matches.points[i].x - seeds[i].x);
    dy.push_back(matches.points[i].y - seeds[i].y);
  }
  summary.median_innovation_px = {median(dx), median(dy)};
  return matches;
}

void FeatureTracker::merge(Matches& matches) const {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!matches.kept[i]) continue;
    for (std::size_t j = i + 1; j < tracks_.size(); ++j) {  // j is younger, or of another camera
      if (distance(matches.points[i], matches.points[j]) < config_.merge_px) matches.kept[j] = 0;
    }
  }
}

void FeatureTracker::apply(const Matches& matches, TrackSummary& summary) {
  std::vector<Track> alive;
  alive.reserve(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!matches.kept[i]) continue;
    reference_patches_.set_fits(tracks_[i].id, matches.matches_reference[i]);
    if (!matches.expected_C.empty()) {
      reference_patches_.update_gradient(tracks_[i].id, {current_.image(), increments_},
                                         motion_of(tracks_[i], i, matches), matches.matches_reference[i]);
    }
    Track track = tracks_[i];
    track.previous_pixel = track.pixel;
    track.previous_point = track.point;
    track.pixel = to_eigen(matches.points[i]);
    track.point = camera_.pixel_to_point(track.pixel);
    ++track.age;
    alive.push_back(track);
  }
  tracks_ = std::move(alive);
  summary.tracked = static_cast<int>(tracks_.size());
}

}  // namespace edged
