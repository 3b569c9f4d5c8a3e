// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tracks features through the images of one camera: the same interface for event frames and for standard frames, and
// for all kinds of trackers.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/frontend/detector.hpp"
#include "edged/frontend/keyframe_policy.hpp"
#include "edged/frontend/outliers.hpp"
#include "edged/frontend/patches/gradient_patch.hpp"
#include "edged/options/frontend.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"
#include "edged/track.hpp"

namespace edged {

// Pixels as OpenCV has them.
inline cv::Point2f to_cv(const Eigen::Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }
inline Eigen::Vector2d to_eigen(const cv::Point2f& p) { return {p.x, p.y}; }
inline float distance(const cv::Point2f& a, const cv::Point2f& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// The predicted motion and depth of the features in the next image.
struct TrackPrediction {
  SE3 T_cur_prev;            ///< previous camera frame to the new one
  double scene_depth = 2.0;  ///< z-depth [m] in the previous camera frame of features without their own
  std::function<std::optional<double>(FeatureId)> depth;  ///< z-depth [m] there of a feature, where known; may be empty
  Eigen::Vector2d offset_px = Eigen::Vector2d::Zero();    ///< added to the position predicted by the poses
  bool reference_patches = true;                          ///< compare features with their reference patches
  BrightnessIncrements increments = {};                   ///< for reference patches on event frames
};

/// What has become of the tracks in one image.
struct TrackSummary {
  int before = 0, tracked = 0;     ///< number of tracks
  bool prediction_failed = false;  ///< the old positions were better seeds and were used
  Eigen::Vector2d median_innovation_px = Eigen::Vector2d::Zero();  ///< measured - expected; zero without prediction
};

/// The next image of the tracks, and where they are expected in it.
struct TrackInput {
  const cv::Mat& image;
  const TrackPrediction* prediction;        ///< null: there is none
  std::vector<Eigen::Vector3d> expected_C;  ///< one per track, in the camera [m]; empty without prediction
  std::vector<cv::Point2f> seeds;           ///< one per track: its expected pixel, or its last one without prediction
};

/// Where the tracks have been found, one entry each.
struct TrackMatches {
  std::vector<cv::Point2f> points;
  std::vector<char> kept;          ///< set where the track goes on
  bool prediction_failed = false;  ///< the old positions were better seeds and were used
};

/// The tracks of one camera, in any kind of tracker. What kinds differ in is protected and virtual: a kind matches the
/// tracks with the next image, and may have references and a detector of its own. A cycle is track, reject_outliers,
/// then at a keyframe (or when needs_detection) detect, and mark_keyframe at a keyframe. Deterministic; one object per
/// camera, not thread safe.
class FeatureTracker {
 public:
  /// camera: model of the images given to track (the ideal pinhole for undistorted event frames).
  FeatureTracker(std::string camera_name, const CameraModel& camera, const TrackerConfig& config);
  virtual ~FeatureTracker() = default;
  FeatureTracker(FeatureTracker&&) = default;
  FeatureTracker& operator=(FeatureTracker&&) = default;

  /// Follows all tracks into image (CV_8UC1, size of the camera). An empty image ends all tracks. Throws InputError
  /// when the size or type does not fit.
  TrackSummary track(const cv::Mat& image, Timestamp t, const std::optional<TrackPrediction>& prediction);

  enum class Reference { Keyframe, Previous };

  /// Drops the tracks that contradict one rigid motion since the reference. R_ref_cur: rotation from the gyro, camera
  /// now to camera then; nothing if the gyro is saturated. Tracks younger than the reference are kept.
  OutlierResult reject_outliers(Reference reference, const std::optional<Eigen::Matrix3d>& R_ref_cur);

  /// Adds features at corners in free cells; image is usually the one just tracked, or an enhanced version of it. Takes
  /// ids from next_id. Returns how many. most: live tracks to end up with, if fewer than the configured number.
  int detect(const cv::Mat& image, FeatureId& next_id, int most = std::numeric_limits<int>::max());

  /// Adds the feature of another camera, found here in the newest image; not one that is followed already. A track at
  /// that place is the same feature under another name and ends.
  void add(FeatureId id, const Eigen::Vector2d& pixel);
  /// Ends the tracks that another part has rejected. Unknown ids are ignored.
  void remove(std::span<const FeatureId> ids);
  /// Null where it is not followed.
  const Track* find(FeatureId id) const;

  /// True when fewer tracks are alive than refill_share of max_features.
  bool needs_detection() const;

  /// From now on the newest image is the keyframe that parallax and outliers are measured against.
  virtual void mark_keyframe();

  /// R_kf_cur: camera now to camera at the last keyframe.
  KeyframeTracks since_keyframe(const Eigen::Matrix3d& R_kf_cur) const;

  /// Ends all tracks and forgets the last image.
  virtual void reset();

  /// In the order of the tracks' ids; sigma = sigma_px / mean focal length.
  CameraObservations observations() const;

  const std::vector<Track>& tracks() const { return tracks_; }
  const CameraModel& camera() const { return camera_; }

 protected:
  /// Finds all tracks in the next image. Called with every image, also without tracks.
  virtual TrackMatches match(const TrackInput& input) = 0;
  /// Takes the newest image as the last one, once tracks that have met have ended in `matches`; tracks() are still
  /// those of the image before.
  virtual void learn(const TrackInput& input, const TrackMatches& matches) = 0;
  /// Corners for new features: at most `limit`, strongest first, none near the pixels of `occupied`.
  virtual std::vector<Corner> find_corners(const cv::Mat& image, std::span<const Eigen::Vector2d> occupied,
                                           int limit) const;

  const TrackerConfig& config() const { return config_; }
  /// 255 where there must be no corners; empty where the whole image is used.
  const cv::Mat& unused_pixels() const { return unused_; }

 private:
  void check_image(const cv::Mat& image) const;
  Track first_track(FeatureId id, const Eigen::Vector2d& pixel) const;
  TrackInput input_of(const cv::Mat& image, const TrackPrediction* prediction) const;
  void merge(TrackMatches& matches) const;
  void apply(const TrackMatches& matches);

  std::string name_;
  CameraModel camera_;
  TrackerConfig config_;
  cv::Mat unused_;
  std::vector<Track> tracks_;  // by id, so oldest first
  Timestamp now_;
  int keyframe_tracks_ = 0;
};

}  // namespace edged
