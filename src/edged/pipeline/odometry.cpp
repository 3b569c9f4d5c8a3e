// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/odometry.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/pipeline/body_motion.hpp"
#include "edged/pipeline/channel.hpp"
#include "edged/pipeline/scene_depth.hpp"

namespace edged {
namespace {

const RigCamera& need(const Rig& rig, Modality modality) {
  const RigCamera* camera = rig.find(modality);
  if (camera == nullptr) {
    throw InputError::format("rig '{}' has no {} camera, which this mode needs: choose another --mode or --rig",
                             rig.name, modality == Modality::Events ? "event" : "frame");
  }
  return *camera;
}

/// The covariance of the pose changes slowly, and takes as long as a third of an optimisation.
constexpr Duration kCovarianceEvery = std::chrono::milliseconds(100);

/// Without a frame for so long, events no longer count on them.
constexpr Duration kFramesMissing = std::chrono::milliseconds(300);

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

/// The packetizer takes the time offsets out; what is left over is up to the estimator.
Rig without_offsets(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.time_offset = Duration(0);
  return rig;
}

}  // namespace

struct Odometry::Impl {
  Impl(const Rig& rig, const ImuNoise& imu_noise, Mode used_mode, const OdometryConfig& used_config,
       Inference inference);

  OdometryOutput process(const Packet& packet);

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
  SE3 T_W_B_of(const Channel& channel) const { return body.moved_on(channel.camera.time_offset); }
  EstimatorResult estimate(const Packet& packet, bool keyframe);
  void start_frame(const SE3& T_new_old);
  NavState in_world(const NavState& state) const;
  void update_covariance(Timestamp t);
  void restart(Timestamp t);
  std::span<const Track> tracks(Modality modality) const;

  Mode mode;
  OdometryConfig config;
  ImuNoise noise;
  Rig given_rig;  ///< the cameras of the mode
  Rig used_rig;   ///< the same as calibrated so far; its time offsets are those left over
  Estimator estimator;
  std::vector<Channel> channels;  ///< events first
  std::optional<EventFrameRenderer> renderer;
  StageTimings timings;

  SE3 T_W_S;  ///< the estimator's own frame in the world: moved when it starts again after a loss
  StatusJudge judge;
  FeatureId next_feature = 1;
  BodyMotion body;  ///< predicted, then optimised
  DimImageStretch dim_frames;
  bool gyro_saturated = false;  ///< since the last keyframe
  bool quiet = false;           ///< the event camera sees nothing move
  SceneDepth depth;
  double scene_depth = 0.0;  ///< of the present packet, for the warp and the tracks [m]
  std::optional<Timestamp> last_keyframe, last_frame;
  std::optional<PoseCovariance> covariance;
  Timestamp covariance_at;
  cv::Mat event_frame;
};

Odometry::Impl::Impl(const Rig& rig, const ImuNoise& imu_noise, Mode used_mode, const OdometryConfig& used_config,
                     Inference inference)
    : mode(used_mode),
      config(used_config),
      noise(imu_noise),
      given_rig(rig_of_mode(rig, used_mode)),
      used_rig(without_offsets(given_rig)),
      estimator(used_rig, imu_noise, used_config.estimator),
      judge(used_config.status),
      body(imu_noise, duration_from_seconds(used_config.packets.max_age_s)),
      dim_frames(used_config.dim_frames),
      depth(used_config.depth, used_rig.cameras.front(), used_config.estimator.depth_factor.enabled, inference) {
  config.validate();
  for (const RigCamera& camera : used_rig.cameras) {
    if (camera.modality == Modality::Events) {
      const CameraModel ideal = ideal_pinhole(camera.model);
      renderer.emplace(UndistortTable(camera.model, ideal), config.event_frame);
      channels.emplace_back(camera, ideal, config.event_tracker, config.alignment, config.health);
    } else {
      channels.emplace_back(camera, camera.model, config.frame_tracker, AlignmentConfig{}, config.health);
    }
  }
}

OdometryOutput Odometry::Impl::process(const Packet& packet) {
  EDGED_CHECK(packet.imu.size() >= 2, "packet at {} ns with {} IMU samples", to_ns(packet.t), packet.imu.size());
  predict(packet);
  measure_depth(packet);
  draw_event_frame(packet);
  take_frame(packet);
  for (Channel& channel : channels) track(channel, packet.t);
  for (Channel& channel : channels) reject(channel);
  const bool keyframe = is_keyframe(packet);
  if (keyframe) mark_keyframe(packet.t);
  const EstimatorResult result = estimate(packet, keyframe);
  if (estimator.initialized()) depth.add_landmarks(packet.t, landmarks_in_view());

  OdometryOutput output;
  output.status = judge.judge(result, estimator.initialized(), packet.t);
  output.state = in_world(body.now());
  update_covariance(packet.t);
  output.covariance = covariance;
  output.keyframe = keyframe;
  output.event_tracks = static_cast<int>(tracks(Modality::Events).size());
  output.frame_tracks = static_cast<int>(tracks(Modality::Frames).size());
  output.landmarks = result.landmarks;
  output.event_rate_hz = packet.event_rate_hz;
  output.scene_depth = scene_depth;
  output.ln_depth_scale = estimator.depth_scale();
  output.waiting_for = result.waiting_for;
  if (output.status == TrackingStatus::Lost) output.lost_because = judge.reason();
  if (output.status == TrackingStatus::Lost && estimator.initialized()) restart(packet.t);
  return output;
}

void Odometry::Impl::predict(const Packet& packet) {
  const auto timer = timings.measure("predict");
  gyro_saturated |= !gyro_trusted(packet.imu, noise);
  body.predict(packet.imu, packet.t, estimator.initialized());
}

void Odometry::Impl::measure_depth(const Packet& packet) {
  const auto timer = timings.measure("depth");
  depth.add_events(std::span(packet.events).last(packet.new_events));
  scene_depth = depth.at(packet.t);
}

/// The packet's window, shortened when the body moves fast: over a long way the warp smears what does not lie at the
/// scene's one depth. Rotation does not count, its warp knows no depth. Empty when there are too few for a frame.
std::span<const Event> Odometry::Impl::drawn_events(const Packet& packet) const {
  const std::span<const Event> window = packet.window();
  const CameraModel& camera = renderer->camera();
  const auto least =
      static_cast<std::size_t>(std::ceil(config.min_events_per_pixel * camera.width() * camera.height()));
  if (window.size() < least) return {};
  if (!estimator.initialized()) return window;
  const double travel_px_per_s = camera.mean_focal() * body.now().v_W.norm() / scene_depth;
  const double age_s = std::min(config.max_travel_px / std::max(travel_px_per_s, 1e-3), config.packets.max_age_s);
  const auto oldest = std::lower_bound(window.begin(), window.end(), packet.t - duration_from_seconds(age_s),
                                       [](const Event& event, Timestamp t) { return event.t < t; });
  return window.last(std::max(static_cast<std::size_t>(window.end() - oldest), least));
}

void Odometry::Impl::draw_event_frame(const Packet& packet) {
  event_frame.release();
  if (!renderer) return;
  const auto timer = timings.measure("event_frame");
  const double pixels = static_cast<double>(renderer->camera().width()) * renderer->camera().height();
  quiet = packet.event_rate_hz < config.quiet_rate_per_pixel * pixels;
  channels.front().show({}, {});
  const std::span<const Event> events = drawn_events(packet);
  if (events.empty() || body.poses().size() < 2) return;
  const RigCamera& camera = channels.front().camera;
  const std::span<const StampedPose> poses = covering(body.poses(), events.front().t + camera.time_offset);
  const CameraMotion motion = camera_motion(poses, T_W_B_of(channels.front()), camera.T_B_C, camera.time_offset);
  if (config.event_frame.depth == EventDepth::Landmarks && estimator.initialized()) {
    const DepthGrid depths = event_depths();
    event_frame = renderer->render(events, motion, scene_depth, &depths);
  } else {
    event_frame = renderer->render(events, motion, scene_depth);
  }
  const cv::Mat enhanced = enhance(event_frame, config.enhance);
  channels.front().show(config.enhance_track ? enhanced : event_frame, config.enhance_detect ? enhanced : event_frame);
}

/// The landmarks of both cameras as the first camera (that of the events, where there is one) sees them now.
std::vector<SeenDepth> Odometry::Impl::landmarks_in_view() const {
  std::vector<SeenDepth> seen;
  const SE3 T_C_W = channels.front().T_W_C(T_W_B_of(channels.front())).inverse();
  for (const Channel& channel : channels) {
    const SE3 T_C_last = T_C_W * channel.T_W_C(channel.T_W_Blast);
    for (const Track& track : channel.tracker.tracks()) {
      const std::optional<double> z = estimator.depth(track.id);
      if (!z) continue;
      const Eigen::Vector3d p_C = T_C_last * (*z * track.point.homogeneous());
      if (p_C.z() > 0.0) seen.push_back({p_C.hnormalized(), p_C.z()});
    }
  }
  return seen;
}

DepthGrid Odometry::Impl::event_depths() const {
  std::vector<DepthSample> samples;
  const CameraModel& camera = renderer->camera();
  for (const SeenDepth& seen : landmarks_in_view()) {
    const Eigen::Vector3d p_C = seen.depth_m * seen.point.homogeneous();
    if (const auto pixel = camera.project(p_C)) samples.push_back({*pixel, seen.depth_m});
  }
  return DepthGrid(camera.width(), camera.height(), config.event_frame.depth_grid, samples, scene_depth);
}

void Odometry::Impl::take_frame(const Packet& packet) {
  if (mode == Mode::Events) return;
  const cv::Mat image = packet.frame ? dim_frames(packet.frame->image) : cv::Mat();
  channels.back().show(image, image);
  if (packet.frame) last_frame = packet.t;
}

void Odometry::Impl::track(Channel& channel, Timestamp t) {
  if (!channel.has_image()) return;
  const auto timer = timings.measure(channel.camera.modality == Modality::Events ? "track_events" : "track_frames");
  channel.track(t, T_W_B_of(channel), scene_depth,
                [this](FeatureId id) { return estimator.initialized() ? estimator.depth(id) : std::nullopt; });
}

void Odometry::Impl::reject(Channel& channel) {
  if (!channel.has_image()) return;
  const auto timer = timings.measure("reject");
  channel.reject(T_W_B_of(channel), !gyro_saturated);
}

bool Odometry::Impl::is_keyframe(const Packet& packet) const {
  const Channel* leader = leading_channel(channels);
  if (leader == nullptr) return false;
  // With both cameras at work a keyframe waits for the next frame, so that both see it.
  const bool frame_due =
      mode == Mode::Fused && !packet.frame && last_frame && packet.t - *last_frame < std::chrono::milliseconds(60);
  if (frame_due) return false;
  SinceKeyframe since;
  since.any = last_keyframe.has_value();
  if (!since.any) return true;
  since.time = packet.t - *last_keyframe;
  // Only the camera that carries the most: corners on event frames drift and end sooner, and would ask for keyframes
  // that good frames do not need.
  const Eigen::Matrix3d R_Ckf_C = leader->since_keyframe(T_W_B_of(*leader));
  since.tracks = leader->tracker.since_keyframe(R_Ckf_C);
  since.rotation_rad = so3::log(Eigen::Quaterniond(R_Ckf_C)).norm();
  return keyframe_reason(since, config.keyframes) != KeyframeReason::None;
}

/// Frames tell more about a corner than events do, where they see it at all: in good light a few corners on the event
/// frame are enough, in the dark, in glare and without frames it takes all it can get.
int Odometry::Impl::corners_wanted(const Channel& channel) const {
  const int all = config.event_tracker.detector.max_features;
  const bool frames_at_work = mode == Mode::Fused && last_frame && body.now().t - *last_frame < kFramesMissing;
  if (channel.camera.modality == Modality::Frames) return config.frame_tracker.detector.max_features;
  if (!frames_at_work) return all;
  return std::max(config.health.min_event_corners, all - static_cast<int>(channels.back().carried()));
}

void Odometry::Impl::mark_keyframe(Timestamp t) {
  const auto timer = timings.measure("detect");
  for (Channel& channel : channels) {
    if (channel.has_image()) channel.mark_keyframe(T_W_B_of(channel), next_feature, corners_wanted(channel));
  }
  last_keyframe = t;
  gyro_saturated = false;
}

EstimatorResult Odometry::Impl::estimate(const Packet& packet, bool keyframe) {
  const auto timer = timings.measure("estimate");
  EstimatorInput input{packet.t, packet.imu, {}, keyframe, quiet, depth.for_factor(packet.t)};
  for (Channel& channel : channels) {
    if (!channel.has_image()) continue;
    channel.T_W_Blast = T_W_B_of(channel);
    input.observations.push_back(channel.observations());
  }
  const EstimatorResult result = estimator.add(input);
  for (Channel& channel : channels) channel.tracker.remove(result.outliers);
  if (!estimator.initialized()) return result;
  const SE3 correction = body.correct(estimator.newest());
  if (result.new_frame) start_frame(correction);
  calibrate();
  for (Channel& channel : channels) {
    if (channel.has_image()) channel.settle(T_W_B_of(channel), keyframe);
  }
  return result;
}

void Odometry::Impl::calibrate() {
  for (std::size_t camera = 0; camera < channels.size(); ++camera) {
    channels[camera].camera = used_rig.cameras[camera] = estimator.window().calibrated(camera);
  }
}

/// The estimator has started, in a frame S of its own. The first start makes it the world; later ones are put where the
/// dead reckoning has come to, position and yaw, so that the trajectory goes on.
void Odometry::Impl::start_frame(const SE3& T_new_old) {
  if (judge.ever_started()) {
    const SE3 T_Sold_Snew = T_new_old.inverse();
    const Eigen::Matrix3d R = (T_W_S * T_Sold_Snew).R();
    const double yaw = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
    const Eigen::Quaterniond q = so3::exp({0.0, 0.0, yaw});
    const Eigen::Vector3d p_W_B = T_W_S * (T_Sold_Snew * body.now().T_W_B.translation());
    T_W_S = SE3(q, p_W_B - q * body.now().T_W_B.translation());
  }
  for (Channel& channel : channels) channel.move(T_new_old);
}

NavState Odometry::Impl::in_world(const NavState& state) const {
  NavState out = state;
  out.T_W_B = T_W_S * state.T_W_B;
  out.v_W = T_W_S.rotation() * state.v_W;
  return out;
}

void Odometry::Impl::update_covariance(Timestamp t) {
  if (covariance && t - covariance_at < kCovarianceEvery && estimator.initialized()) return;
  const auto timer = timings.measure("covariance");
  covariance.reset();
  covariance_at = t;
  if (const std::optional<Matrix15d> P = estimator.covariance()) {
    const Eigen::Matrix3d R_W_S = T_W_S.R();
    covariance = {R_W_S * P->topLeftCorner<3, 3>() * R_W_S.transpose(), P->block<3, 3>(3, 3)};
  }
}

void Odometry::Impl::restart(Timestamp t) {
  spdlog::warn("lost at {:.3f} s: {}; starting again", to_seconds(t), judge.reason());
  estimator = Estimator(used_rig, noise, config.estimator);
}

std::span<const Track> Odometry::Impl::tracks(Modality modality) const {
  for (const Channel& channel : channels) {
    if (channel.camera.modality == modality) return channel.tracker.tracks();
  }
  return {};
}

Odometry::Odometry(const Rig& rig, const ImuNoise& imu_noise, Mode mode, const OdometryConfig& config,
                   Inference inference)
    : impl_(std::make_unique<Impl>(rig, imu_noise, mode, config, inference)) {}
Odometry::~Odometry() = default;

OdometryOutput Odometry::process(const Packet& packet) { return impl_->process(packet); }
Rig Odometry::rig() const {
  Rig rig = impl_->used_rig;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    rig.cameras[camera].time_offset += impl_->given_rig.cameras[camera].time_offset;
  }
  return rig;
}
std::optional<Eigen::Matrix4d> Odometry::calibration_covariance(const std::string& camera) {
  const std::vector<RigCamera>& cameras = impl_->used_rig.cameras;
  const auto found = std::ranges::find(cameras, camera, &RigCamera::name);
  if (found == cameras.end()) return std::nullopt;
  return impl_->estimator.calibration_covariance(static_cast<std::size_t>(found - cameras.begin()));
}
const StageTimings& Odometry::timings() const { return impl_->timings; }
const cv::Mat& Odometry::event_frame() const { return impl_->event_frame; }
std::span<const Track> Odometry::tracks(Modality modality) const { return impl_->tracks(modality); }

}  // namespace edged
