// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The method, packet by packet: `process` is the paper's data flow, one line a step.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/estimator/estimator.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/frontend/low_light.hpp"
#include "edged/imu_noise.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/body_motion.hpp"
#include "edged/pipeline/channel.hpp"
#include "edged/pipeline/event_view.hpp"
#include "edged/pipeline/mapper.hpp"
#include "edged/pipeline/packetizer.hpp"
#include "edged/pipeline/scene_depth.hpp"
#include "edged/pipeline/status_judge.hpp"
#include "edged/pipeline/world_frame.hpp"
#include "edged/rig.hpp"
#include "edged/step.hpp"
#include "edged/timing.hpp"

namespace edged {

/// Synchronous and deterministic: the same packets give the same bits; but for a depth network that has a thread of its
/// own.
class PacketOdometry {
 public:
  /// cameras: those of the run, event cameras first; config: validated.
  PacketOdometry(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config, Inference inference);

  /// Packets in time order. Never throws on data; lost tracking is a status.
  Step process(Packet packet);
  /// A clock was set back, and the packets that follow are of a new time: tracks and estimate end. The next start goes
  /// on from where the body was, as after a loss.
  void begin_time();

  /// Of the stages; whoever calls may add his own.
  StageTimings& timings() { return timings_; }
  /// As of Odometry.
  void load_map(std::string_view bytes);
  std::optional<std::string> save_map() const;
  bool awaiting_relocalization() const { return mapper_.awaiting_relocalization(); }
  FinalTrajectory final_trajectory() const;
  Rig rig() const;
  std::optional<Eigen::Matrix4d> calibration_covariance(const std::string& camera) const;

 private:
  Estimator fresh_estimator() const { return {rig_, noise_, config_.estimator}; }
  /// One depth for all cameras, as the first sees it, of the event cameras where there is one: a depth network looks
  /// through one camera only.
  SceneDepth fresh_depth() const {
    return {config_.depth, rig_.cameras.front(), config_.estimator.depth_factor.enabled, inference_};
  }
  void make_channels();
  Preintegration predict(const Packet& packet);
  double measure_depth(const Packet& packet);
  std::vector<EventImage> draw(const Packet& packet, double scene_depth);
  std::optional<DepthGrid> event_depths(const Channel& channel, const CameraModel& ideal, double scene_depth) const;
  std::vector<SeenDepth> landmarks_seen_by(const Channel& viewer) const;
  std::vector<ChannelView> views_of(const Packet& packet, std::span<const EventImage> rendered);
  void track(const ChannelView& view, Timestamp t, double scene_depth);
  void reject(const ChannelView& view);
  bool is_keyframe(const Packet& packet, std::span<const ChannelView> views) const;
  bool is_fused() const { return !event_views_.empty() && event_views_.size() < channels_.size(); }
  double carried_by_frames() const;
  bool frames_at_work() const;
  bool frames_carry() const;
  int features_wanted(const Channel& channel) const;
  void mark_keyframe(Timestamp t, std::span<const ChannelView> views);
  EstimatorResult estimate(const Packet& packet, Preintegration motion, std::span<const ChannelView> views,
                           bool keyframe);
  bool follow_map(Timestamp t, std::span<const ChannelView> views, const EstimatorResult& result, bool keyframe);
  void calibrate();
  void update_covariance(Timestamp t);
  bool is_quiet(const Packet& packet) const;
  Step describe(Packet packet, std::span<const EventImage> rendered, const EstimatorResult& result,
                TrackingStatus status) const;

  /// The body at the instant of the channel's image: the packet's, but for what the camera's clock is still off by.
  SE3 T_W_B_of(const Channel& channel) const { return body_.moved_on(channel.camera.time_offset); }

  OdometryConfig config_;
  Inference inference_;
  bool gyro_clipped_ = false;    ///< in this packet
  bool turned_unseen_ = false;   ///< it was until this packet
  bool gyro_saturated_ = false;  ///< since the last keyframe
  ImuNoise noise_;
  Rig given_rig_;  ///< the cameras of the run
  Rig rig_;        ///< the same as calibrated so far; its time offsets are those left over
  Estimator estimator_;
  std::vector<Channel> channels_;              ///< as in rig_
  std::vector<EventView> event_views_;         ///< of the event cameras, the first channels
  std::vector<LowLightNormalizer> low_light_;  ///< of the frame cameras, the others
  StageTimings timings_;

  WorldFrame world_;
  Mapper mapper_;
  FinalTrajectory before_;  ///< of the times before the newest clock
  StatusJudge judge_;
  FeatureId next_feature_ = 1;
  BodyMotion body_;  ///< predicted, then optimised
  SceneDepth depth_;
  std::optional<Timestamp> last_keyframe_, last_frame_;
  std::optional<PoseCovariance> covariance_;
  Timestamp covariance_at_;
  Timestamp dead_reckoning_until_ =
      Timestamp::min();  ///< without an estimate the IMU alone moves the body on, until then
};

}  // namespace edged
