// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The method, packet by packet: `process` is the paper's data flow, one line a step.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/camera/rig.hpp"
#include "edged/core/timing.hpp"
#include "edged/events/accumulate.hpp"
#include "edged/imu/noise.hpp"
#include "edged/pipeline/body_motion.hpp"
#include "edged/pipeline/channel.hpp"
#include "edged/pipeline/odometry_config.hpp"
#include "edged/pipeline/packetizer.hpp"
#include "edged/pipeline/scene_depth.hpp"
#include "edged/pipeline/step.hpp"

namespace edged {

/// Synchronous and deterministic: the same packets give the same bits; but for a depth network that has a thread of its
/// own.
class PacketOdometry {
 public:
  /// config: validated. Throws InputError when the rig lacks a camera the mode needs.
  PacketOdometry(const Rig& rig, const ImuNoise& noise, Mode mode, const OdometryConfig& config, Inference inference);

  /// Packets in time order. Never throws on data; lost tracking is a status.
  Step process(Packet packet);

  /// Of the stages; whoever calls may add his own.
  StageTimings& timings() { return timings_; }
  /// As of Odometry.
  Rig rig() const;
  std::optional<Eigen::Matrix4d> calibration_covariance(const std::string& camera);

 private:
  void predict(const Packet& packet);
  void measure_depth(const Packet& packet);
  std::span<const Event> drawn_events(const Packet& packet) const;
  void draw_event_frame(const Packet& packet);
  std::vector<SeenDepth> landmarks_in_view() const;
  DepthGrid event_depths() const;
  void take_frame(const Packet& packet);
  void track(Channel& channel, Timestamp t);
  void reject(Channel& channel);
  bool is_keyframe(const Packet& packet) const;
  int corners_wanted(const Channel& channel) const;
  void mark_keyframe(Timestamp t);
  void calibrate();
  /// The body at the instant of the channel's image: the packet's, but for what the camera's clock is still off by.
  SE3 T_W_B_of(const Channel& channel) const { return body_.moved_on(channel.camera.time_offset); }
  EstimatorResult estimate(const Packet& packet, bool keyframe);
  void start_frame(const SE3& T_new_old);
  NavState in_world(const NavState& state) const;
  void update_covariance(Timestamp t);
  Step describe(Packet packet, EstimatorResult result, TrackingStatus status, bool keyframe) const;

  Mode mode_;
  OdometryConfig config_;
  ImuNoise noise_;
  Rig given_rig_;  ///< the cameras of the mode
  Rig rig_;        ///< the same as calibrated so far; its time offsets are those left over
  Estimator estimator_;
  std::vector<Channel> channels_;  ///< events first
  std::optional<EventFrameRenderer> renderer_;
  StageTimings timings_;

  SE3 T_W_S_;  ///< the estimator's own frame in the world: moved when it starts again after a loss
  StatusJudge judge_;
  FeatureId next_feature_ = 1;
  BodyMotion body_;  ///< predicted, then optimised
  DimImageStretch dim_frames_;
  bool gyro_saturated_ = false;  ///< since the last keyframe
  bool quiet_ = false;           ///< the event camera sees nothing move
  SceneDepth depth_;
  double scene_depth_ = 0.0;  ///< of the present packet, for the warp and the tracks [m]
  std::optional<Timestamp> last_keyframe_, last_frame_;
  std::optional<PoseCovariance> covariance_;
  Timestamp covariance_at_;
  cv::Mat event_frame_;
  std::size_t drawn_ = 0;  ///< events in it
};

}  // namespace edged
