// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/odometry.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <span>

#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

/// One camera's tracks and where the body was at their last image and last keyframe.
struct Channel {
  Channel(const RigCamera& rig_camera, const CameraModel& image_model, const TrackerConfig& config)
      : camera(rig_camera), tracker(rig_camera.name, image_model, config) {}

  SE3 T_W_C(const SE3& T_W_B) const { return T_W_B * camera.T_B_C; }

  RigCamera camera;
  FeatureTracker tracker;
  cv::Mat image;      ///< of the present packet; empty when it brought none
  cv::Mat corners;    ///< the image to find corners on: the same, or an enhanced one
  SE3 T_W_Blast;      ///< at the last image
  SE3 T_W_Bkeyframe;  ///< at the last keyframe
  bool any_image = false;
  /// delta x_last of paper Eq. 2 [px]. The paper shifts the event frame by it, and tracks measured there would have to
  /// be shifted back; to shift the places where they are searched instead is the same, and leaves the frame where the
  /// poses put it.
  Eigen::Vector2d alignment_px = Eigen::Vector2d::Zero();
};

const RigCamera& need(const Rig& rig, Modality modality) {
  const RigCamera* camera = rig.find(modality);
  if (camera == nullptr) {
    throw InputError::format("rig '{}' has no {} camera, which this mode needs: choose another --mode or --rig", rig.name,
                             modality == Modality::Events ? "event" : "frame");
  }
  return *camera;
}

/// False when a sample reached the range of the gyro or samples are missing.
bool gyro_trusted(const std::vector<ImuSample>& imu, const ImuNoise& noise) {
  for (std::size_t i = 0; i < imu.size(); ++i) {
    if (imu[i].gyro_B.cwiseAbs().maxCoeff() >= noise.gyro_saturation) return false;
    if (i > 0 && imu[i].t - imu[i - 1].t > kMaxSampleInterval) return false;
  }
  return true;
}

/// The poses from the last one not after t on, at least two. One twist (Eq. 1) is that of the events' time only.
std::span<const StampedPose> covering(const std::vector<StampedPose>& poses, Timestamp t) {
  std::size_t first = poses.size() - 2;
  while (first > 0 && poses[first].t > t) --first;
  return std::span(poses).subspan(first);
}

Rig rig_of_mode(const Rig& rig, Mode mode) {
  Rig used{rig.name, {}};
  if (mode != Mode::Frames) used.cameras.push_back(need(rig, Modality::Events));
  if (mode != Mode::Events) used.cameras.push_back(need(rig, Modality::Frames));
  return used;
}

}  // namespace

std::string to_string(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::Initializing: return "Initializing";
    case TrackingStatus::Good: return "Good";
    case TrackingStatus::Degraded: return "Degraded";
    case TrackingStatus::Lost: return "Lost";
  }
  EDGED_CHECK(false, "status {}", static_cast<int>(status));
}

struct Odometry::Impl {
  Impl(const Rig& rig, const ImuNoise& imu_noise, Mode used_mode, const OdometryConfig& used_config);

  OdometryOutput process(const Packet& packet);

  void predict(const Packet& packet);
  void draw_event_frame(const Packet& packet);
  DepthGrid event_depths() const;
  void take_frame(const Packet& packet);
  void align(Channel& channel, const TrackSummary& summary) const;
  void track(Channel& channel, Timestamp t);
  void reject(Channel& channel);
  bool is_keyframe(const Packet& packet) const;
  void mark_keyframe(Timestamp t);
  EstimatorResult estimate(const Packet& packet, bool keyframe);
  void update_depth();
  void start_frame(const SE3& T_new_old);
  NavState in_world(const NavState& state) const;
  void restart(Timestamp t);
  TrackingStatus judge(const EstimatorResult& result, Timestamp t);
  int tracks(Modality modality) const;

  Mode mode;
  OdometryConfig config;
  ImuNoise noise;
  Rig used_rig;                     ///< the cameras of the mode
  Estimator estimator;
  std::vector<Channel> channels;  ///< events first
  std::optional<EventFrameRenderer> renderer;
  StageTimings timings;

  SE3 T_W_S;                        ///< the estimator's own frame in the world: moved when it starts again after a loss
  bool ever_started = false;
  FeatureId next_feature = 1;
  NavState now;                     ///< predicted, then optimised; before the start attitude by gyro only
  std::vector<StampedPose> T_W_B;   ///< body poses at the IMU samples, back to the oldest event of a packet's window
  bool gyro_saturated = false;      ///< since the last keyframe
  bool quiet = false;               ///< the event camera sees nothing move
  double scene_depth;
  std::optional<Timestamp> last_keyframe, last_frame, last_supported;
  cv::Mat event_frame;
};

Odometry::Impl::Impl(const Rig& rig, const ImuNoise& imu_noise, Mode used_mode, const OdometryConfig& used_config)
    : mode(used_mode),
      config(used_config),
      noise(imu_noise),
      used_rig(rig_of_mode(rig, used_mode)),
      estimator(used_rig, imu_noise, used_config.estimator),
      scene_depth(used_config.initial_depth_m) {
  config.validate();
  for (const RigCamera& camera : used_rig.cameras) {
    if (camera.modality == Modality::Events) {
      const CameraModel ideal = ideal_pinhole(camera.model);
      renderer.emplace(UndistortTable(camera.model, ideal), config.event_frame);
      channels.emplace_back(camera, ideal, config.event_tracker);
    } else {
      channels.emplace_back(camera, camera.model, config.frame_tracker);
    }
  }
}

OdometryOutput Odometry::Impl::process(const Packet& packet) {
  EDGED_CHECK(packet.imu.size() >= 2, "packet at {} ns with {} IMU samples", to_ns(packet.t), packet.imu.size());
  predict(packet);
  draw_event_frame(packet);
  take_frame(packet);
  for (Channel& channel : channels) track(channel, packet.t);
  for (Channel& channel : channels) reject(channel);
  const bool keyframe = is_keyframe(packet);
  if (keyframe) mark_keyframe(packet.t);
  const EstimatorResult result = estimate(packet, keyframe);
  update_depth();

  OdometryOutput output;
  output.status = judge(result, packet.t);
  output.state = in_world(now);
  output.keyframe = keyframe;
  output.event_tracks = tracks(Modality::Events);
  output.frame_tracks = tracks(Modality::Frames);
  output.landmarks = result.landmarks;
  output.event_rate_hz = packet.event_rate_hz;
  output.scene_depth = scene_depth;
  output.waiting_for = result.waiting_for;
  if (output.status == TrackingStatus::Lost && estimator.initialized()) restart(packet.t);
  return output;
}

void Odometry::Impl::predict(const Packet& packet) {
  const auto timer = timings.measure("predict");
  gyro_saturated |= !gyro_trusted(packet.imu, noise);
  const Timestamp oldest = packet.t - duration_from_seconds(config.packets.max_age_s);
  std::erase_if(T_W_B, [&](const StampedPose& pose) { return pose.t < oldest || pose.t >= packet.imu.front().t; });
  if (estimator.initialized()) {
    for (const NavState& state : propagate_all(now, packet.imu)) T_W_B.push_back({state.t, state.T_W_B});
    now = propagate(now, Preintegration(packet.imu, now.bias_gyro, now.bias_accel, noise));
  } else {
    // Neither speed nor tilt are known yet: turn with the gyro, stay in place.
    SE3 pose = now.T_W_B;
    for (std::size_t i = 0; i < packet.imu.size(); ++i) {
      if (i > 0) {
        const double dt = to_seconds(packet.imu[i].t - packet.imu[i - 1].t);
        const Eigen::Vector3d rate = 0.5 * (packet.imu[i].gyro_B + packet.imu[i - 1].gyro_B);
        pose = pose * SE3(so3::exp(rate * dt), Eigen::Vector3d::Zero());
      }
      T_W_B.push_back({packet.imu[i].t, pose});
    }
    now.T_W_B = pose;
  }
  now.t = packet.t;
}

void Odometry::Impl::draw_event_frame(const Packet& packet) {
  event_frame.release();
  if (!renderer) return;
  const auto timer = timings.measure("event_frame");
  const double pixels = static_cast<double>(renderer->camera().width()) * renderer->camera().height();
  quiet = packet.event_rate_hz < config.quiet_rate_per_pixel * pixels;
  channels.front().image.release();
  if (packet.window().empty() || T_W_B.size() < 2) return;
  if (static_cast<double>(packet.window().size()) < config.min_events_per_pixel * pixels) return;
  const std::span<const StampedPose> poses = covering(T_W_B, packet.window().front().t);
  const CameraMotion motion = camera_motion(poses, now.T_W_B, channels.front().camera.T_B_C);
  if (config.event_frame.depth == DepthSource::Landmarks && estimator.initialized()) {
    const DepthGrid depths = event_depths();
    event_frame = renderer->render(packet.window(), motion, scene_depth, &depths);
  } else {
    event_frame = renderer->render(packet.window(), motion, scene_depth);
  }
  const cv::Mat enhanced = enhance(event_frame, config.enhance);
  channels.front().image = config.enhance_track ? enhanced : event_frame;
  channels.front().corners = config.enhance_detect ? enhanced : event_frame;
}

/// The landmarks of both cameras as the event camera is predicted to see them now.
DepthGrid Odometry::Impl::event_depths() const {
  std::vector<DepthSample> samples;
  const SE3 T_C_W = channels.front().T_W_C(now.T_W_B).inverse();
  for (const Channel& channel : channels) {
    const SE3 T_C_last = T_C_W * channel.T_W_C(channel.T_W_Blast);
    for (const Track& track : channel.tracker.tracks()) {
      const std::optional<double> depth = estimator.depth(track.id);
      if (!depth) continue;
      const Eigen::Vector3d p_C = T_C_last * (*depth * track.point.homogeneous());
      if (const auto pixel = renderer->camera().project(p_C)) samples.push_back({*pixel, p_C.z()});
    }
  }
  const CameraModel& camera = renderer->camera();
  return DepthGrid(camera.width(), camera.height(), config.event_frame.depth_grid, samples, scene_depth);
}

void Odometry::Impl::take_frame(const Packet& packet) {
  if (mode == Mode::Events) return;
  channels.back().image = channels.back().corners = packet.frame ? packet.frame->image : cv::Mat();
  if (packet.frame) last_frame = packet.t;
}

void Odometry::Impl::track(Channel& channel, Timestamp t) {
  if (channel.image.empty()) return;
  const auto timer = timings.measure(channel.camera.modality == Modality::Events ? "track_events" : "track_frames");
  std::optional<TrackPrediction> prediction;
  if (channel.any_image) {
    prediction.emplace();
    prediction->T_cur_prev = channel.T_W_C(now.T_W_B).inverse() * channel.T_W_C(channel.T_W_Blast);
    prediction->scene_depth = scene_depth;
    prediction->depth = [this](FeatureId id) { return estimator.initialized() ? estimator.depth(id) : std::nullopt; };
  }
  if (prediction) prediction->offset_px = channel.alignment_px;
  align(channel, channel.tracker.track(channel.image, t, prediction));
  channel.any_image = true;
}

void Odometry::Impl::align(Channel& channel, const TrackSummary& summary) const {
  if (config.alignment_gain <= 0.0 || channel.camera.modality != Modality::Events) return;
  // Without a usable prediction the old correction fades.
  const bool measured = summary.tracked > 0 && !summary.prediction_failed;
  const Eigen::Vector2d newest =
      measured ? Eigen::Vector2d(summary.median_innovation_px + channel.alignment_px) : Eigen::Vector2d::Zero();
  channel.alignment_px += config.alignment_gain * (newest - channel.alignment_px);
  const double length = channel.alignment_px.norm();
  if (length > config.alignment_max_px) channel.alignment_px *= config.alignment_max_px / length;
}

void Odometry::Impl::reject(Channel& channel) {
  if (channel.image.empty()) return;
  const auto timer = timings.measure("reject");
  const Eigen::Matrix3d R_Bkf_B = (channel.T_W_Bkeyframe.rotation().conjugate() * now.T_W_B.rotation()).toRotationMatrix();
  const Eigen::Matrix3d R_B_C = channel.camera.T_B_C.R();
  const std::optional<Eigen::Matrix3d> R_Ckf_C = R_B_C.transpose() * R_Bkf_B * R_B_C;
  channel.tracker.reject_outliers(FeatureTracker::Reference::Keyframe, gyro_saturated ? std::nullopt : R_Ckf_C);
}

bool Odometry::Impl::is_keyframe(const Packet& packet) const {
  const bool any_image = std::any_of(channels.begin(), channels.end(), [](const auto& c) { return !c.image.empty(); });
  if (!any_image) return false;
  // With both cameras at work a keyframe waits for the next frame, so that both see it.
  const bool frame_due = mode == Mode::Fused && !packet.frame && last_frame && packet.t - *last_frame < std::chrono::milliseconds(60);
  if (frame_due) return false;
  SinceKeyframe since;
  since.any = last_keyframe.has_value();
  if (!since.any) return true;
  since.time = packet.t - *last_keyframe;
  for (const Channel& channel : channels) {
    if (channel.image.empty()) continue;
    const Eigen::Quaterniond q = channel.T_W_Bkeyframe.rotation().conjugate() * now.T_W_B.rotation();
    const Eigen::Matrix3d R_B_C = channel.camera.T_B_C.R();
    since.tracks += channel.tracker.since_keyframe(R_B_C.transpose() * q.toRotationMatrix() * R_B_C);
    since.rotation_rad = std::max(since.rotation_rad, so3::log(q).norm());
  }
  return keyframe_reason(since, config.keyframes) != KeyframeReason::None;
}

void Odometry::Impl::mark_keyframe(Timestamp t) {
  const auto timer = timings.measure("detect");
  for (Channel& channel : channels) {
    if (channel.image.empty()) continue;
    channel.tracker.detect(channel.corners, next_feature);
    channel.tracker.mark_keyframe();
    channel.T_W_Bkeyframe = now.T_W_B;
  }
  last_keyframe = t;
  gyro_saturated = false;
}

EstimatorResult Odometry::Impl::estimate(const Packet& packet, bool keyframe) {
  const auto timer = timings.measure("estimate");
  EstimatorInput input{packet.t, packet.imu, {}, keyframe, quiet};
  for (Channel& channel : channels) {
    if (channel.image.empty()) continue;
    channel.T_W_Blast = now.T_W_B;
    input.observations.push_back(channel.tracker.observations());
  }
  const bool started = estimator.initialized();
  const EstimatorResult result = estimator.add(input);
  for (Channel& channel : channels) channel.tracker.remove(result.outliers);
  if (!estimator.initialized()) return result;
  const SE3 correction = estimator.newest().T_W_B * now.T_W_B.inverse();
  now = estimator.newest();
  for (StampedPose& pose : T_W_B) pose.T = correction * pose.T;
  if (!started) start_frame(correction);
  for (Channel& channel : channels) {
    if (!channel.image.empty()) channel.T_W_Blast = now.T_W_B;
    if (!channel.image.empty() && keyframe) channel.T_W_Bkeyframe = now.T_W_B;
  }
  return result;
}

void Odometry::Impl::update_depth() {
  if (!estimator.initialized()) return;
  for (const Channel& channel : channels) {
    if (const auto depth = estimator.median_depth(channel.camera.name)) {
      scene_depth = *depth;
      return;
    }
  }
}

/// The estimator has started, in a frame S of its own. The first start makes it the world; later ones are put where the
/// dead reckoning has come to, position and yaw, so that the trajectory goes on.
void Odometry::Impl::start_frame(const SE3& T_new_old) {
  if (ever_started) {
    const SE3 T_Sold_Snew = T_new_old.inverse();
    const Eigen::Matrix3d R = (T_W_S * T_Sold_Snew).R();
    const double yaw = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
    const Eigen::Quaterniond q = so3::exp({0.0, 0.0, yaw});
    const Eigen::Vector3d p_W_B = T_W_S * (T_Sold_Snew * now.T_W_B.translation());
    T_W_S = SE3(q, p_W_B - q * now.T_W_B.translation());
  }
  ever_started = true;
  last_supported.reset();
  for (Channel& channel : channels) {
    channel.T_W_Blast = T_new_old * channel.T_W_Blast;
    channel.T_W_Bkeyframe = T_new_old * channel.T_W_Bkeyframe;
  }
}

NavState Odometry::Impl::in_world(const NavState& state) const {
  NavState out = state;
  out.T_W_B = T_W_S * state.T_W_B;
  out.v_W = T_W_S.rotation() * state.v_W;
  return out;
}

void Odometry::Impl::restart(Timestamp t) {
  spdlog::warn("lost at {:.3f} s: starting again", to_seconds(t));
  estimator = Estimator(used_rig, noise, config.estimator);
  scene_depth = config.initial_depth_m;
}

TrackingStatus Odometry::Impl::judge(const EstimatorResult& result, Timestamp t) {
  if (!estimator.initialized()) return ever_started ? TrackingStatus::Lost : TrackingStatus::Initializing;
  if (!result.plausible) return TrackingStatus::Lost;
  if (result.standstill || result.landmarks_seen >= config.min_landmarks || !last_supported) last_supported = t;
  const double alone_s = to_seconds(t - *last_supported);
  if (alone_s > config.lost_after_s) return TrackingStatus::Lost;
  return alone_s > config.degraded_after_s ? TrackingStatus::Degraded : TrackingStatus::Good;
}

int Odometry::Impl::tracks(Modality modality) const {
  for (const Channel& channel : channels) {
    if (channel.camera.modality == modality) return static_cast<int>(channel.tracker.tracks().size());
  }
  return 0;
}

Odometry::Odometry(const Rig& rig, const ImuNoise& imu_noise, Mode mode, const OdometryConfig& config)
    : impl_(std::make_unique<Impl>(rig, imu_noise, mode, config)) {}
Odometry::~Odometry() = default;

OdometryOutput Odometry::process(const Packet& packet) { return impl_->process(packet); }
const StageTimings& Odometry::timings() const { return impl_->timings; }
const cv::Mat& Odometry::event_frame() const { return impl_->event_frame; }

}  // namespace edged
