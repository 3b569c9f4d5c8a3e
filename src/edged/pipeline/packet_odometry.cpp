// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/packet_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

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
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    if (const RigCamera* camera = used_camera(rig, mode, modality)) used.cameras.push_back(*camera);
  }
  return used;
}

/// The packetizer takes the time offsets out; what is left over is up to the estimator.
Rig without_offsets(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.time_offset = Duration(0);
  return rig;
}

}  // namespace

PacketOdometry::PacketOdometry(const Rig& rig, const ImuNoise& noise, Mode mode, const OdometryConfig& config,
                               Inference inference)
    : mode_(mode),
      config_(config),
      noise_(noise),
      given_rig_(rig_of_mode(rig, mode)),
      rig_(without_offsets(given_rig_)),
      estimator_(rig_, noise, config.estimator),
      judge_(config.status),
      body_(noise, duration_from_seconds(config.packets.max_age_s)),
      dim_frames_(config.dim_frames),
      depth_(config.depth, rig_.cameras.front(), config.estimator.depth_factor.enabled, inference) {
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      const CameraModel ideal = ideal_pinhole(camera.model);
      renderer_.emplace(UndistortTable(camera.model, ideal), config_.event_frame);
      channels_.emplace_back(camera, ideal, config_.event_tracker, config_.alignment, config_.health);
    } else {
      channels_.emplace_back(camera, camera.model, config_.frame_tracker, AlignmentConfig{}, config_.health);
    }
  }
}

Step PacketOdometry::process(Packet packet) {
  EDGED_CHECK(packet.imu.size() >= 2, "packet at {} ns with {} IMU samples", to_ns(packet.t), packet.imu.size());
  predict(packet);
  measure_depth(packet);
  draw_event_frame(packet);
  take_frame(packet);
  for (Channel& channel : channels_) track(channel, packet.t);
  for (Channel& channel : channels_) reject(channel);
  const bool keyframe = is_keyframe(packet);
  if (keyframe) mark_keyframe(packet.t);
  EstimatorResult result = estimate(packet, keyframe);
  if (estimator_.initialized()) depth_.add_landmarks(packet.t, landmarks_in_view());
  const TrackingStatus status = judge_.judge(result, estimator_.initialized(), packet.t);
  update_covariance(packet.t);
  Step step = describe(std::move(packet), std::move(result), status, keyframe);
  if (status == TrackingStatus::Lost && estimator_.initialized()) {
    estimator_ = Estimator(rig_, noise_, config_.estimator);  // it starts again
  }
  return step;
}

Step PacketOdometry::describe(Packet packet, EstimatorResult result, TrackingStatus status, bool keyframe) const {
  Step step;
  step.t = packet.t;
  step.status = status;
  step.state = in_world(body_.now());
  step.covariance = covariance_;
  step.keyframe = keyframe;
  step.waiting_for = std::move(result.waiting_for);
  step.started = std::move(result.started);
  if (status == TrackingStatus::Lost) step.lost_because = judge_.reason();
  for (const Channel& channel : channels_) {
    (channel.camera.modality == Modality::Events ? step.event_tracks : step.frame_tracks) = channel.tracker.tracks();
  }
  step.landmarks = std::move(result.landmarks);
  for (Landmark& landmark : step.landmarks) landmark.p_W = T_W_S_ * landmark.p_W;
  step.event_frame = event_frame_;
  step.frame = std::move(packet.frame);
  step.events = std::move(packet.events);
  step.drawn = drawn_;
  step.event_rate_hz = packet.event_rate_hz;
  step.scene_depth = scene_depth_;
  step.ln_depth_scale = estimator_.depth_scale();
  return step;
}

void PacketOdometry::predict(const Packet& packet) {
  const auto timer = timings_.measure("predict");
  gyro_saturated_ |= !gyro_trusted(packet.imu, noise_);
  body_.predict(packet.imu, packet.t, estimator_.initialized());
}

void PacketOdometry::measure_depth(const Packet& packet) {
  const auto timer = timings_.measure("depth");
  depth_.add_events(std::span(packet.events).last(packet.new_events));
  scene_depth_ = depth_.at(packet.t);
}

/// The packet's window, shortened when the body moves fast: over a long way the warp smears what does not lie at the
/// scene's one depth. Rotation does not count, its warp knows no depth. Empty when there are too few for a frame.
std::span<const Event> PacketOdometry::drawn_events(const Packet& packet) const {
  const std::span<const Event> window = packet.window();
  const CameraModel& camera = renderer_->camera();
  const auto least =
      static_cast<std::size_t>(std::ceil(config_.min_events_per_pixel * camera.width() * camera.height()));
  if (window.size() < least) return {};
  if (!estimator_.initialized()) return window;
  const double travel_px_per_s = camera.mean_focal() * body_.now().v_W.norm() / scene_depth_;
  const double age_s = std::min(config_.max_travel_px / std::max(travel_px_per_s, 1e-3), config_.packets.max_age_s);
  const auto oldest = std::lower_bound(window.begin(), window.end(), packet.t - duration_from_seconds(age_s),
                                       [](const Event& event, Timestamp t) { return event.t < t; });
  return window.last(std::max(static_cast<std::size_t>(window.end() - oldest), least));
}

void PacketOdometry::draw_event_frame(const Packet& packet) {
  event_frame_.release();
  drawn_ = 0;
  if (!renderer_) return;
  const auto timer = timings_.measure("event_frame");
  const double pixels = static_cast<double>(renderer_->camera().width()) * renderer_->camera().height();
  quiet_ = packet.event_rate_hz < config_.quiet_rate_per_pixel * pixels;
  channels_.front().show({}, {});
  const std::span<const Event> events = drawn_events(packet);
  if (events.empty() || body_.poses().size() < 2) return;
  drawn_ = events.size();
  const RigCamera& camera = channels_.front().camera;
  const std::span<const StampedPose> poses = covering(body_.poses(), events.front().t + camera.time_offset);
  const CameraMotion motion = camera_motion(poses, T_W_B_of(channels_.front()), camera.T_B_C, camera.time_offset);
  if (config_.event_frame.depth == EventDepth::Landmarks && estimator_.initialized()) {
    const DepthGrid depths = event_depths();
    event_frame_ = renderer_->render(events, motion, scene_depth_, &depths);
  } else {
    event_frame_ = renderer_->render(events, motion, scene_depth_);
  }
  const cv::Mat enhanced = enhance(event_frame_, config_.enhance);
  channels_.front().show(config_.enhance_track ? enhanced : event_frame_,
                         config_.enhance_detect ? enhanced : event_frame_);
}

/// The landmarks of both cameras as the first camera (that of the events, where there is one) sees them now.
std::vector<SeenDepth> PacketOdometry::landmarks_in_view() const {
  std::vector<SeenDepth> seen;
  const SE3 T_C_W = channels_.front().T_W_C(T_W_B_of(channels_.front())).inverse();
  for (const Channel& channel : channels_) {
    const SE3 T_C_last = T_C_W * channel.T_W_C(channel.T_W_Blast);
    for (const Track& track : channel.tracker.tracks()) {
      const std::optional<double> z = estimator_.depth(track.id);
      if (!z) continue;
      const Eigen::Vector3d p_C = T_C_last * (*z * track.point.homogeneous());
      if (p_C.z() > 0.0) seen.push_back({p_C.hnormalized(), p_C.z()});
    }
  }
  return seen;
}

DepthGrid PacketOdometry::event_depths() const {
  std::vector<DepthSample> samples;
  const CameraModel& camera = renderer_->camera();
  for (const SeenDepth& seen : landmarks_in_view()) {
    const Eigen::Vector3d p_C = seen.depth_m * seen.point.homogeneous();
    if (const auto pixel = camera.project(p_C)) samples.push_back({*pixel, seen.depth_m});
  }
  return DepthGrid(camera.width(), camera.height(), config_.event_frame.depth_grid, samples, scene_depth_);
}

void PacketOdometry::take_frame(const Packet& packet) {
  if (mode_ == Mode::Events) return;
  const cv::Mat image = packet.frame ? dim_frames_(packet.frame->image) : cv::Mat();
  channels_.back().show(image, image);
  if (packet.frame) last_frame_ = packet.t;
}

void PacketOdometry::track(Channel& channel, Timestamp t) {
  if (!channel.has_image()) return;
  const auto timer = timings_.measure(channel.camera.modality == Modality::Events ? "track_events" : "track_frames");
  channel.track(t, T_W_B_of(channel), scene_depth_,
                [this](FeatureId id) { return estimator_.initialized() ? estimator_.depth(id) : std::nullopt; });
}

void PacketOdometry::reject(Channel& channel) {
  if (!channel.has_image()) return;
  const auto timer = timings_.measure("reject");
  channel.reject(T_W_B_of(channel), !gyro_saturated_);
}

bool PacketOdometry::is_keyframe(const Packet& packet) const {
  const Channel* leader = leading_channel(channels_);
  if (leader == nullptr) return false;
  // With both cameras at work a keyframe waits for the next frame, so that both see it.
  const bool frame_due =
      mode_ == Mode::Fused && !packet.frame && last_frame_ && packet.t - *last_frame_ < std::chrono::milliseconds(60);
  if (frame_due) return false;
  SinceKeyframe since;
  since.any = last_keyframe_.has_value();
  if (!since.any) return true;
  since.time = packet.t - *last_keyframe_;
  // Only the camera that carries the most: corners on event frames drift and end sooner, and would ask for keyframes
  // that good frames do not need.
  const Eigen::Matrix3d R_Ckf_C = leader->since_keyframe(T_W_B_of(*leader));
  since.tracks = leader->tracker.since_keyframe(R_Ckf_C);
  since.rotation_rad = so3::log(Eigen::Quaterniond(R_Ckf_C)).norm();
  return keyframe_reason(since, config_.keyframes) != KeyframeReason::None;
}

/// Frames tell more about a corner than events do, where they see it at all: in good light a few corners on the event
/// frame are enough, in the dark, in glare and without frames it takes all it can get.
int PacketOdometry::corners_wanted(const Channel& channel) const {
  const int all = config_.event_tracker.detector.max_features;
  const bool frames_at_work = mode_ == Mode::Fused && last_frame_ && body_.now().t - *last_frame_ < kFramesMissing;
  if (channel.camera.modality == Modality::Frames) return config_.frame_tracker.detector.max_features;
  if (!frames_at_work) return all;
  return std::max(config_.health.min_event_corners, all - static_cast<int>(channels_.back().carried()));
}

void PacketOdometry::mark_keyframe(Timestamp t) {
  const auto timer = timings_.measure("detect");
  for (Channel& channel : channels_) {
    if (channel.has_image()) channel.mark_keyframe(T_W_B_of(channel), next_feature_, corners_wanted(channel));
  }
  last_keyframe_ = t;
  gyro_saturated_ = false;
}

EstimatorResult PacketOdometry::estimate(const Packet& packet, bool keyframe) {
  const auto timer = timings_.measure("estimate");
  EstimatorInput input{packet.t, packet.imu, {}, keyframe, quiet_, depth_.for_factor(packet.t)};
  for (Channel& channel : channels_) {
    if (!channel.has_image()) continue;
    channel.T_W_Blast = T_W_B_of(channel);
    input.observations.push_back(channel.observations());
  }
  const EstimatorResult result = estimator_.add(input);
  for (Channel& channel : channels_) channel.tracker.remove(result.outliers);
  if (!estimator_.initialized()) return result;
  const SE3 correction = body_.correct(estimator_.newest());
  if (result.new_frame) start_frame(correction);
  calibrate();
  for (Channel& channel : channels_) {
    if (channel.has_image()) channel.settle(T_W_B_of(channel), keyframe);
  }
  return result;
}

void PacketOdometry::calibrate() {
  for (std::size_t camera = 0; camera < channels_.size(); ++camera) {
    channels_[camera].camera = rig_.cameras[camera] = estimator_.window().calibrated(camera);
  }
}

/// The estimator has started, in a frame S of its own. The first start makes it the world; later ones are put where the
/// dead reckoning has come to, position and yaw, so that the trajectory goes on.
void PacketOdometry::start_frame(const SE3& T_new_old) {
  if (judge_.ever_started()) {
    const SE3 T_Sold_Snew = T_new_old.inverse();
    const Eigen::Matrix3d R = (T_W_S_ * T_Sold_Snew).R();
    const double yaw = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
    const Eigen::Quaterniond q = so3::exp({0.0, 0.0, yaw});
    const Eigen::Vector3d p_W_B = T_W_S_ * (T_Sold_Snew * body_.now().T_W_B.translation());
    T_W_S_ = SE3(q, p_W_B - q * body_.now().T_W_B.translation());
  }
  for (Channel& channel : channels_) channel.move(T_new_old);
}

NavState PacketOdometry::in_world(const NavState& state) const {
  NavState out = state;
  out.T_W_B = T_W_S_ * state.T_W_B;
  out.v_W = T_W_S_.rotation() * state.v_W;
  return out;
}

void PacketOdometry::update_covariance(Timestamp t) {
  if (covariance_ && t - covariance_at_ < kCovarianceEvery && estimator_.initialized()) return;
  const auto timer = timings_.measure("covariance");
  covariance_.reset();
  covariance_at_ = t;
  if (const std::optional<Matrix15d> P = estimator_.covariance()) {
    const Eigen::Matrix3d R_W_S = T_W_S_.R();
    covariance_ = {R_W_S * P->topLeftCorner<3, 3>() * R_W_S.transpose(), P->block<3, 3>(3, 3)};
  }
}

Rig PacketOdometry::rig() const {
  Rig rig = rig_;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    rig.cameras[camera].time_offset += given_rig_.cameras[camera].time_offset;
  }
  return rig;
}

std::optional<Eigen::Matrix4d> PacketOdometry::calibration_covariance(const std::string& camera) {
  const auto found = std::ranges::find(rig_.cameras, camera, &RigCamera::name);
  if (found == rig_.cameras.end()) return std::nullopt;
  return estimator_.calibration_covariance(static_cast<std::size_t>(found - rig_.cameras.begin()));
}

}  // namespace edged
