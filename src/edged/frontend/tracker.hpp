// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tracks features through the images of one camera: the same class for event frames and for standard frames.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/frontend/detector.hpp"
#include "edged/frontend/keyframe_policy.hpp"
#include "edged/frontend/klt.hpp"
#include "edged/frontend/outliers.hpp"
#include "edged/frontend/patches/reference_patches.hpp"
#include "edged/options/frontend.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"
#include "edged/track.hpp"

namespace edged {

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

/// A cycle is track, reject_outliers, then at a keyframe (or when needs_detection) detect, and mark_keyframe at a
/// keyframe. Deterministic; one object per camera, not thread safe.
class FeatureTracker {
 public:
  /// camera: model of the images given to track (the ideal pinhole for undistorted event frames).
  FeatureTracker(std::string camera_name, const CameraModel& camera, const TrackerConfig& config);

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
  void add_feature(FeatureId id, const Eigen::Vector2d& pixel);
  /// Null where it is not followed.
  const Track* find(FeatureId id) const;

  /// True when fewer tracks are alive than refill_share of max_features.
  bool needs_detection() const;

  /// From now on the newest image is the keyframe that parallax and outliers are measured against.
  void mark_keyframe();

  /// R_kf_cur: camera now to camera at the last keyframe.
  KeyframeTracks since_keyframe(const Eigen::Matrix3d& R_kf_cur) const;

  /// Ends the tracks that another part has rejected. Unknown ids are ignored.
  void remove(std::span<const FeatureId> ids);

  /// Ends all tracks and forgets the last image.
  void reset();

  /// In the order of the tracks' ids; sigma = sigma_px / mean focal length.
  CameraObservations observations() const;

  const std::vector<Track>& tracks() const { return tracks_; }
  const CameraModel& camera() const { return camera_; }

 private:
  struct Matches {
    std::vector<cv::Point2f> points;
    std::vector<char> kept;               ///< set where the track goes on
    std::vector<char> matches_reference;  ///< set to the position that matches the reference patch
    std::vector<Eigen::Vector3d>
        expected_C;  ///< one per track, for the warp of its reference patch [m]; empty: unknown
  };

  void check_image(const cv::Mat& image) const;
  Track first_track(FeatureId id, const Eigen::Vector2d& pixel) const;
  std::vector<Eigen::Vector3d> expected(const TrackPrediction& prediction) const;
  std::vector<cv::Point2f> projected(const std::vector<Eigen::Vector3d>& points_C,
                                     const Eigen::Vector2d& offset_px) const;
  Matches match(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& seeds,
                std::vector<Eigen::Vector3d> expected_C) const;
  Matches match_all(const std::optional<TrackPrediction>& prediction, TrackSummary& summary) const;
  /// The i-th track in the newest image.
  static FeatureMotion motion_of(const Track& track, std::size_t i, const Matches& matches);
  bool align(std::size_t i, Matches& matches) const;
  void match_back(const std::vector<cv::Point2f>& from, const std::vector<std::size_t>& which, Matches& matches) const;
  void merge(Matches& matches) const;
  void apply(const Matches& matches, TrackSummary& summary);

  std::string name_;
  CameraModel camera_;
  TrackerConfig config_;
  cv::Mat unused_;             // for the detector; empty where the whole image is used
  std::vector<Track> tracks_;  // by id, so oldest first
  Timestamp now_;
  int keyframe_tracks_ = 0;
  ReferencePatches reference_patches_;
  BrightnessIncrements increments_;  // of the newest image
  ImagePyramid previous_, current_;  // current_ is the newest only while track runs
};

}  // namespace edged
