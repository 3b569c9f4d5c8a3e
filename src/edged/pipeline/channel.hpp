// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One camera of the rig at work: its tracks, and where the body was at its last image and last keyframe.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "edged/frontend/tracker.hpp"
#include "edged/options.hpp"
#include "edged/rig.hpp"

namespace edged {

class Channel {
 public:
  /// image_model: of the images given to it (the ideal pinhole for undistorted event frames).
  Channel(const RigCamera& rig_camera, const CameraModel& image_model, const TrackerConfig& config,
          const AlignmentConfig& alignment, const HealthConfig& health)
      : camera(rig_camera), tracker(rig_camera.name, image_model, config), alignment_(alignment), health_(health) {}

  SE3 T_W_C(const SE3& T_W_B) const { return T_W_B * camera.T_B_C; }
  /// Rotation of the camera from now to the last keyframe, R_Ckf_C.
  Eigen::Matrix3d since_keyframe(const SE3& T_W_B) const;

  /// Follows the tracks into the image. T_W_B: the body now, as predicted; prediction: what else is known, without its
  /// pose and offset.
  void track(const cv::Mat& image, Timestamp t, const SE3& T_W_B, TrackPrediction prediction);
  /// Drops tracks that contradict one rigid motion since the keyframe; trust_gyro: with its rotation.
  void reject(const SE3& T_W_B, bool trust_gyro);
  /// Finds new features in the image, up to `most` live ones, and makes it the keyframe.
  void mark_keyframe(const cv::Mat& image, const SE3& T_W_B, FeatureId& next_feature, int most);

  /// Running mean of the share of tracks that live through an image, 0 .. 1: blur, noise and darkness end tracks.
  double survival_rate() const { return survival_rate_; }
  /// Tracks as they count: as many as are likely to be there in the next image.
  double carried() const { return survival_rate_ * static_cast<double>(tracker.tracks().size()); }
  /// The observations of the present image, less sure the fewer tracks survive; none when the camera is ignored.
  CameraObservations observations() const;

  /// The body at the present image (and keyframe), now better known.
  void settle(const SE3& T_W_B, bool keyframe);
  /// Everything remembered moves into another world frame.
  void move(const SE3& T_new_old);

  RigCamera camera;  ///< as the estimator has calibrated it
  FeatureTracker tracker;
  SE3 T_W_Blast;      ///< at the last image
  SE3 T_W_Bkeyframe;  ///< at the last keyframe

 private:
  void align(const TrackSummary& summary);
  void weigh(const TrackSummary& summary, Timestamp t);

  AlignmentConfig alignment_;
  HealthConfig health_;
  double survival_rate_ = 1.0;
  Timestamp last_image_;
  bool any_image_ = false;
  // delta x_last [px]. The paper shifts the event frame by it, and tracks measured there would have to be shifted back;
  // to shift the places where they are searched instead is the same, and leaves the frame where the poses put it.
  Eigen::Vector2d alignment_px_ = Eigen::Vector2d::Zero();
};

/// A camera with its image of a packet: features are followed on `track` and found on `detect`.
struct ChannelView {
  Channel* channel;
  cv::Mat track, detect;
};

/// The camera that carries the most tracks, the last of equals (frames); null without any.
const Channel* leading_channel(std::span<const ChannelView> views);

}  // namespace edged
