// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Vision by tracked features: renders event frames, tracks features in the images of all cameras and rejects outliers.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "edged/frontend/low_light.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/pipeline/localization/imu_propagator.hpp"
#include "edged/pipeline/vision/camera_tracker.hpp"
#include "edged/pipeline/vision/event_view.hpp"
#include "edged/pipeline/vision/scene_depth.hpp"
#include "edged/pipeline/vision/stereo.hpp"
#include "edged/pipeline/vision/vision.hpp"
#include "edged/rig.hpp"
#include "edged/timing.hpp"

namespace edged {

/// One object for all cameras of a run. Deterministic, except with a depth network in a thread of its own.
class ImageVision : public Vision {
 public:
  /// cameras: those of the run, event cameras first, without time offsets: packets have none; config: validated.
  ImageVision(const Rig& cameras, const OdometryConfig& config, Inference inference, StageTimings& timings);

  VisionOutput process(const VisionInput& input) override;
  void correct(const VisionCorrection& correction, const ImuPropagator& body) override;
  void begin_epoch() override;
  std::vector<CameraStep> describe(Packet packet, const VisionOutput& output) const override;

 private:
  /// One depth for all cameras: that of the first event camera, or of the first camera without one, as a depth network
  /// has one camera only.
  SceneDepth fresh_depth() const {
    return {config_.depth, rig_.cameras.front(), config_.estimator.depth_factor.enabled, inference_};
  }
  void make_trackers();
  double measure_depth(const Packet& packet);
  std::vector<EventImage> render(const VisionInput& input, double scene_depth);
  std::optional<DepthGrid> event_depths(std::size_t camera, const ImuPropagator& body, double scene_depth) const;
  std::vector<SeenDepth> landmarks_seen_by(const CameraTracker& viewer, const ImuPropagator& body) const;
  std::vector<CameraImage> views_of(const Packet& packet, std::span<const EventImage> event_images);
  void track(const CameraImage& view, const VisionInput& input, double scene_depth);
  void reject(std::span<const CameraImage> views, const ImuPropagator& body);
  bool is_keyframe(const VisionInput& input, std::span<const CameraImage> views) const;
  void match_across(const CameraImage& from, const CameraImage& to, const ImuPropagator& body);
  std::optional<double> landmark_depth(const CameraTracker& tracker, FeatureId id) const;
  void mark_keyframe(const VisionInput& input, std::span<CameraImage> views, double scene_depth);
  void expect_events(std::span<CameraImage> views, const ImuPropagator& body, double scene_depth) const;
  bool is_fused() const { return !event_views_.empty() && event_views_.size() < trackers_.size(); }
  double effective_frame_tracks() const;
  bool frames_available(Timestamp t) const;
  bool frames_sufficient(Timestamp t) const;
  int features_wanted(const CameraTracker& tracker, Timestamp t) const;
  bool is_static(const Packet& packet, std::span<const EventImage> event_images);
  std::vector<TrackedImage> images_of(std::span<const CameraImage> views) const;

  OdometryConfig config_;
  Inference inference_;
  bool gyro_saturated_ = false;  ///< since the last keyframe
  bool provisional_ = true;      ///< by the last correction
  Rig rig_;                      ///< with online calibration
  StageTimings* timings_;
  std::vector<EventView> event_views_;         ///< one per event camera, the first of the rig
  std::vector<LowLightNormalizer> low_light_;  ///< one per frame camera, the others
  std::vector<CameraTracker> trackers_;        ///< as in rig_
  SceneDepth depth_;
  FeatureId next_feature_ = 1;
  std::optional<Timestamp> last_keyframe_, last_frame_;
  std::optional<LandmarkDepths> landmarks_;  ///< by the last correction
};

}  // namespace edged
