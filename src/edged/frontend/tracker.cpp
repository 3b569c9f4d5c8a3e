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

/// 255 where the detector of this camera must not place corners.
cv::Mat unused_pixels_of(const CameraModel& camera, int border_px) {
  if (!camera.view_limit() && !camera.is_masked()) return {};
  cv::Mat unused(camera.height(), camera.width(), CV_8UC1);
  for (int y = 0; y < unused.rows; ++y)
    for (int x = 0; x < unused.cols; ++x)
      unused.at<uchar>(y, x) = camera.contains({static_cast<double>(x), static_cast<double>(y)}, border_px) ? 0 : 255;
  return unused;
}

Eigen::Vector2d median_innovation(const TrackInput& input, const TrackMatches& matches) {
  std::vector<double> dx, dy;
  for (std::size_t i = 0; i < matches.points.size(); ++i) {
    if (!matches.kept[i]) continue;
    dx.push_back(matches.points[i].x - input.seeds[i].x);
    dy.push_back(matches.points[i].y - input.seeds[i].y);
  }
  return {median(dx), median(dy)};
}

}  // namespace

FeatureTracker::FeatureTracker(std::string camera_name, const CameraModel& camera, const TrackerConfig& config)
    : name_(std::move(camera_name)),
      camera_(camera),
      config_(config),
      unused_(unused_pixels_of(camera, config.detector.border_px)) {
  EDGED_CHECK(camera.width() > 0 && camera.height() > 0, "camera {} has no size", name_);
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
  const TrackInput input = input_of(image, prediction ? &*prediction : nullptr);
  TrackMatches matches = match(input);
  if (prediction && !matches.prediction_failed) summary.median_innovation_px = median_innovation(input, matches);
  summary.prediction_failed = matches.prediction_failed;
  merge(matches);
  learn(input, matches);
  apply(matches);
  summary.tracked = static_cast<int>(tracks_.size());
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
  const std::vector<Corner> corners = find_corners(image, occupied, limit);
  for (const Corner& corner : corners) {
    tracks_.push_back(first_track(next_id++, corner.pixel));
  }
  return static_cast<int>(corners.size());
}

const Track* FeatureTracker::find(FeatureId id) const {
  const auto track = std::ranges::lower_bound(tracks_, id, {}, &Track::id);
  return track != tracks_.end() && track->id == id ? &*track : nullptr;
}

void FeatureTracker::add(FeatureId id, const Eigen::Vector2d& pixel) {
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

std::vector<Corner> FeatureTracker::find_corners(const cv::Mat& image, std::span<const Eigen::Vector2d> occupied,
                                                 int limit) const {
  return detect_corners(image, occupied, limit, config_.detector, unused_);
}

TrackInput FeatureTracker::input_of(const cv::Mat& image, const TrackPrediction* prediction) const {
  TrackInput input{image, prediction, {}, {}};
  input.seeds.reserve(tracks_.size());
  for (const Track& track : tracks_) {
    if (!prediction) {
      input.seeds.push_back(to_cv(track.pixel));
      continue;
    }
    const std::optional<double> own = prediction->depth ? prediction->depth(track.id) : std::nullopt;
    const Eigen::Vector3d& p_C = input.expected_C.emplace_back(
        prediction->T_cur_prev * (own.value_or(prediction->scene_depth) * track.point.homogeneous()));
    const std::optional<Eigen::Vector2d> pixel = camera_.project(p_C);
    // A position far outside marks a point behind the camera: no tracker finds it there.
    input.seeds.push_back(pixel ? to_cv(*pixel + prediction->offset_px) : cv::Point2f(-1e6F, -1e6F));
  }
  return input;
}

void FeatureTracker::merge(TrackMatches& matches) const {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!matches.kept[i]) continue;
    for (std::size_t j = i + 1; j < tracks_.size(); ++j) {  // j is younger, or of another camera
      if (distance(matches.points[i], matches.points[j]) < config_.merge_px) matches.kept[j] = 0;
    }
  }
}

void FeatureTracker::apply(const TrackMatches& matches) {
  std::vector<Track> alive;
  alive.reserve(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!matches.kept[i]) continue;
    Track track = tracks_[i];
    track.previous_pixel = track.pixel;
    track.previous_point = track.point;
    track.pixel = to_eigen(matches.points[i]);
    track.point = camera_.pixel_to_point(track.pixel);
    ++track.age;
    alive.push_back(track);
  }
  tracks_ = std::move(alive);
}

}  // namespace edged
