// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The tracks of one camera of the rig, and the poses of the body at its last image and last keyframe.
#pragma once

#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>

#include "edged/events/flicker.hpp"
#include "edged/frontend/tracker_table.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/localization/imu_propagator.hpp"
#include "edged/pipeline/vision/exposure_shift.hpp"
#include "edged/rig.hpp"

namespace edged {

class CameraTracker {
 public:
  /// image_model: camera model of its images (the ideal pinhole for undistorted event frames).
  CameraTracker(const RigCamera& rig_camera, const CameraModel& image_model, const TrackerConfig& config,
                const AlignmentConfig& alignment, const HealthConfig& health)
      : camera(rig_camera),
        features(make_tracker(rig_camera.name, image_model, config)),
        alignment_(alignment),
        health_(health) {}

  SE3 T_O_C(const SE3& T_O_B) const { return T_O_B * camera.T_B_C; }
  /// The body at the instant of the image of a packet: at its time, plus the residual time offset of the camera.
  SE3 T_O_B_now(const ImuPropagator& body) const { return body.extrapolate(camera.time_offset); }
  /// Rotation of the camera from now to the last keyframe, R_Ckf_C.
  Eigen::Matrix3d since_keyframe(const SE3& T_O_B) const;

  /// Tracks the features into the image. T_O_B: the predicted pose of the body; prediction: all but pose and offset.
  /// lamp: of an image with an exposure, if a lamp flickers.
  void track(const cv::Mat& image, Timestamp t, const SE3& T_O_B, TrackPrediction prediction,
             const std::optional<LampCycle>& lamp);
  /// Drops tracks that contradict one rigid motion since the keyframe; trust_gyro: with the rotation of the gyro.
  void reject(const SE3& T_O_B, bool trust_gyro) const;
  /// Makes the newest image the keyframe.
  void mark_keyframe(const SE3& T_O_B);

  /// Track survival rate: running mean of the share of tracks that survive an image, 0 .. 1.
  double survival_rate() const { return survival_rate_; }
  /// Effective number of tracks: the number that likely survives the next image.
  double effective_tracks() const { return survival_rate_ * static_cast<double>(features->tracks().size()); }
  /// The observations at the stamp of the present image, with a sigma that grows as fewer tracks survive; none when the
  /// camera is ignored.
  CameraObservations observations() const;

  bool has_image_of(Timestamp t) const { return any_image_ && last_image_ == t; }
  /// Infinite before the first one.
  double since_last_image_s(Timestamp t) const {
    return any_image_ ? to_seconds(t - last_image_) : std::numeric_limits<double>::infinity();
  }
  /// Sets the estimated pose of the body at the present image (and keyframe).
  void set_pose(const SE3& T_O_B, bool keyframe);
  /// Transforms all stored poses to another odometry frame.
  void move(const SE3& T_new_old);

  RigCamera camera;                          ///< with the calibration of the estimator
  std::unique_ptr<FeatureTracker> features;  ///< of the kind that the option says
  bool only_one_of_its_kind = false;         ///< in the run
  SE3 T_O_Blast;                             ///< at the last image
  SE3 T_O_Bkeyframe;                         ///< at the last keyframe

 private:
  void align(const TrackSummary& summary);
  void update_survival_rate(const TrackSummary& summary, Timestamp t);

  AlignmentConfig alignment_;
  HealthConfig health_;
  double survival_rate_ = 1.0;
  Timestamp last_image_;
  bool any_image_ = false;
  ExposureShift shift_;
  // delta x_last [px]. The paper shifts the event frame by it, and tracks measured there would have to be shifted back;
  // shifting the search positions instead is equivalent, and keeps the frame consistent with the poses.
  Eigen::Vector2d alignment_px_ = Eigen::Vector2d::Zero();
};

/// A camera with its image of a packet: features are tracked on `track` and detected on `detect`.
struct CameraImage {
  CameraTracker* tracker;
  cv::Mat track, detect;
  cv::Mat increments = {};  ///< event frames only (EventImage)
  Duration covered = {};
  cv::Mat as_events =
      {};  ///< keyframes of frame cameras only: as event cameras behind other lenses would see the scene
};

/// The camera with most tracks, the last of equals (frames); null without any.
const CameraTracker* leading_tracker(std::span<const CameraImage> views);

}  // namespace edged
