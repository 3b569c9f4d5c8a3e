// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/packet_odometry.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/events/enhance.hpp"

namespace edged {
namespace {

/// The covariance of the pose changes slowly, and takes as long as a third of an optimisation.
constexpr Duration kCovarianceEvery = std::chrono::milliseconds(100);

/// Of fewer features than that on frames there is no map, but of those on event frames beside them.
constexpr double kFeaturesForMap = 20.0;

/// Without a frame for so long, events no longer count on them.
constexpr Duration kFramesMissing = std::chrono::milliseconds(300);

/// After a loss for want of anything in view, the IMU alone tells for so long where the body goes.
constexpr Duration kDeadReckoning = std::chrono::seconds(10);

/// The packetizer takes the time offsets out; what is left over is up to the estimator.
Rig without_offsets(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.time_offset = Duration(0);
  return rig;
}

}  // namespace

PacketOdometry::PacketOdometry(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config,
                               Inference inference)
    : config_(config),
      inference_(inference),
      noise_(noise),
      given_rig_(cameras),
      rig_(without_offsets(given_rig_)),
      estimator_(fresh_estimator()),
      mapper_(config.map),
      judge_(config.status),
      body_(noise, duration_from_seconds(config.packets.max_age_s)),
      depth_(fresh_depth()) {
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      event_views_.emplace_back(camera.model, config_);
    } else {
      low_light_.emplace_back(config_.low_light);
    }
  }
  make_channels();
}

void PacketOdometry::make_channels() {
  channels_.clear();
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      const CameraModel& ideal = event_views_[channels_.size()].ideal();
      channels_.emplace_back(camera, ideal, config_.event_tracker, config_.alignment, config_.health);
    } else {
      channels_.emplace_back(camera, camera.model, config_.frame_tracker, AlignmentConfig{}, config_.health);
    }
  }
}

void PacketOdometry::begin_time() {
  estimator_ = fresh_estimator();
  make_channels();
  depth_ = fresh_depth();
  before_ = final_trajectory();
  mapper_ = Mapper(config_.map);  // its keyframes are of the time before
  judge_.lose("a clock was set back");
  dead_reckoning_until_ = Timestamp::min();
  last_keyframe_.reset();
  last_frame_.reset();
  covariance_.reset();
  gyro_saturated_ = false;
}

Step PacketOdometry::process(Packet packet) {
  EDGED_CHECK(packet.imu.size() >= 2, "packet at {} ns with {} IMU samples", to_ns(packet.t), packet.imu.size());
  Preintegration motion = predict(packet);
  const double scene_depth = measure_depth(packet);
  const std::vector<EventImage> rendered = draw(packet, scene_depth);
  const std::vector<ChannelView> views = views_of(packet, rendered);
  for (const ChannelView& view : views) track(view, packet.t, scene_depth);
  for (const ChannelView& view : views) reject(view);
  const bool keyframe = is_keyframe(packet, views);
  if (keyframe) mark_keyframe(packet.t, views);
  const EstimatorResult result = estimate(packet, std::move(motion), views, keyframe);
  const TrackingStatus status = judge_.judge(result, estimator_.initialized(), packet.t);
  const bool relocalized = follow_map(packet.t, views, result, keyframe);
  update_covariance(packet.t);
  if (is_tracking(status)) mapper_.note(body_.now());
  Step step = describe(std::move(packet), rendered, result, status);
  step.keyframe = keyframe;
  step.relocalized = relocalized;
  step.scene_depth = scene_depth;
  if (status == TrackingStatus::Lost && estimator_.initialized()) {
    estimator_ = fresh_estimator();
    dead_reckoning_until_ = judge_.vision_lost() ? step.t + kDeadReckoning : step.t;
  }
  return step;
}

Step PacketOdometry::describe(Packet packet, std::span<const EventImage> rendered, const EstimatorResult& result,
                              TrackingStatus status) const {
  Step step;
  step.t = packet.t;
  step.status = status;
  step.state = world_.of(body_.now());
  step.covariance = covariance_;
  step.waiting_for = result.waiting_for;
  step.started = result.started;
  if (status == TrackingStatus::Lost) step.lost_because = judge_.reason();
  step.cameras.reserve(channels_.size());  // OpenCV's images may throw when moved: growing would copy the events
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Channel& channel = channels_[i];
    CameraStep camera{.name = channel.camera.name, .modality = channel.camera.modality};
    camera.tracks = channel.tracker.tracks();
    camera.survival_rate = channel.survival_rate();
    if (i < rendered.size()) {
      camera.image = rendered[i].frame;
      camera.events = std::move(packet.events[i].events);
      camera.rendered = rendered[i].rendered;
      camera.event_rate_hz = packet.events[i].event_rate_hz;
    } else if (const Frame* frame = packet.find_frame(camera.name)) {
      camera.image = frame->image;
    }
    step.cameras.push_back(std::move(camera));
  }
  step.T_W_O = world_.T_W_S();
  step.map_matches = mapper_.map_matches(packet.t);
  step.landmarks = world_.of(result.landmarks);
  step.marginalized_keyframes = world_.of(result.marginalized_keyframes);
  step.ln_depth_scale = estimator_.depth_scale();
  return step;
}

Preintegration PacketOdometry::predict(const Packet& packet) {
  const auto timer = timings_.measure("predict");
  Preintegration motion = body_.predict(packet.imu, estimator_.initialized() || packet.t < dead_reckoning_until_);
  gyro_saturated_ |= !motion.gyro_trusted();
  turned_unseen_ = gyro_clipped_ && !motion.gyro_clipped();
  gyro_clipped_ = motion.gyro_clipped();
  return motion;
}

double PacketOdometry::measure_depth(const Packet& packet) {
  const auto timer = timings_.measure("depth");
  if (!packet.events.empty()) {
    const PacketEvents& first = packet.events.front();
    depth_.add_events(std::span(first.events).last(first.new_events));
  }
  return depth_.at(packet.t);
}

/// One image an event camera, empty where there were too few events.
std::vector<EventImage> PacketOdometry::draw(const Packet& packet, double scene_depth) {
  std::vector<EventImage> rendered(event_views_.size());
  for (std::size_t i = 0; i < rendered.size(); ++i) {
    const auto timer = timings_.measure("event_frame");
    EventView& view = event_views_[i];
    const EventsToRender events = view.rendered_events(packet.events[i], body_, scene_depth, frames_carry());
    if (events.events.empty()) continue;
    const std::optional<DepthGrid> depths = event_depths(channels_[i], view.ideal(), scene_depth);
    rendered[i] = view.render(events, channels_[i].camera, body_, scene_depth, depths ? &*depths : nullptr);
  }
  return rendered;
}

/// The landmarks of all cameras as that one sees them now.
std::vector<SeenDepth> PacketOdometry::landmarks_seen_by(const Channel& viewer) const {
  std::vector<SeenDepth> seen;
  const SE3 T_C_W = viewer.T_W_C(T_W_B_of(viewer)).inverse();
  for (const Channel& channel : channels_) {
    const SE3 T_C_last = T_C_W * channel.T_W_C(channel.T_W_Blast);
    for (const Track& track : channel.tracker.tracks()) {
      const std::optional<double> z = estimator_.depth(track.id, channel.camera.name);
      if (!z) continue;
      const Eigen::Vector3d p_C = T_C_last * (*z * track.point.homogeneous());
      if (p_C.z() > 0.0) seen.push_back({p_C.hnormalized(), p_C.z()});
    }
  }
  return seen;
}

/// Of every event in its place; nothing where one depth does for the whole scene, or no other is known.
std::optional<DepthGrid> PacketOdometry::event_depths(const Channel& channel, const CameraModel& ideal,
                                                      double scene_depth) const {
  if (config_.event_frame.depth != EventDepth::Landmarks || !estimator_.initialized()) return std::nullopt;
  std::vector<DepthSample> samples;
  for (const SeenDepth& seen : landmarks_seen_by(channel)) {
    const Eigen::Vector3d p_C = seen.depth_m * seen.point.homogeneous();
    if (const auto pixel = ideal.project(p_C)) samples.push_back({*pixel, seen.depth_m});
  }
  return DepthGrid(ideal.width(), ideal.height(), config_.event_frame.depth_grid, samples, scene_depth);
}

/// The cameras that the packet brought an image of.
std::vector<ChannelView> PacketOdometry::views_of(const Packet& packet, std::span<const EventImage> rendered) {
  std::vector<ChannelView> views;
  for (std::size_t i = 0; i < rendered.size(); ++i) {
    if (!rendered[i].frame.empty()) views.push_back({&channels_[i], rendered[i].track, rendered[i].detect});
  }
  for (std::size_t i = rendered.size(); i < channels_.size(); ++i) {
    const Frame* frame = packet.find_frame(channels_[i].camera.name);
    if (frame == nullptr) continue;
    const cv::Mat image = low_light_[i - rendered.size()](frame->image);
    views.push_back({&channels_[i], image, image});
    last_frame_ = packet.t;
  }
  return views;
}

void PacketOdometry::track(const ChannelView& view, Timestamp t, double scene_depth) {
  Channel& channel = *view.channel;
  const auto timer = timings_.measure(channel.camera.modality == Modality::Events ? "track_events" : "track_frames");
  TrackPrediction prediction;
  prediction.scene_depth = scene_depth;
  prediction.depth = [this, &channel](FeatureId id) {
    return estimator_.initialized() ? estimator_.depth(id, channel.camera.name) : std::nullopt;
  };
  // Against one look all errors of a track hang together, and the thresholds of a start do not know that: with events
  // alone 3 of 72 starts are wrong by their scale, 1 without.
  prediction.reference_patches = !estimator_.provisional();
  channel.track(view.track, t, T_W_B_of(channel), std::move(prediction));
}

void PacketOdometry::reject(const ChannelView& view) {
  const auto timer = timings_.measure("reject");
  view.channel->reject(T_W_B_of(*view.channel), !gyro_saturated_);
}

bool PacketOdometry::is_keyframe(const Packet& packet, std::span<const ChannelView> views) const {
  const Channel* leader = leading_channel(views);
  if (leader == nullptr) return false;
  // With both cameras at work a keyframe waits for the next frame, so that both see it.
  const bool frame_due =
      is_fused() && packet.frames.empty() && last_frame_ && packet.t - *last_frame_ < std::chrono::milliseconds(60);
  if (frame_due) return false;
  SinceKeyframe since;
  since.any = last_keyframe_.has_value();
  if (!since.any) return true;
  since.time = packet.t - *last_keyframe_;
  // Only the camera that carries the most: features on event frames drift and end sooner, and would ask for keyframes
  // that good frames do not need.
  const Eigen::Matrix3d R_Ckf_C = leader->since_keyframe(T_W_B_of(*leader));
  since.tracks = leader->tracker.since_keyframe(R_Ckf_C);
  since.rotation_rad = so3::log(Eigen::Quaterniond(R_Ckf_C)).norm();
  return keyframe_reason(since, config_.keyframes) != KeyframeReason::None;
}

double PacketOdometry::carried_by_frames() const {
  double carried = 0.0;
  for (std::size_t i = event_views_.size(); i < channels_.size(); ++i) carried += channels_[i].carried();
  return carried;
}

bool PacketOdometry::frames_at_work() const {
  return is_fused() && last_frame_ && body_.now().t - *last_frame_ < kFramesMissing;
}

/// As many features as event frames keep beside them.
bool PacketOdometry::frames_carry() const {
  return frames_at_work() && carried_by_frames() >= config_.health.min_event_features;
}

/// Frames tell more about a feature than events do, where they see it at all: in good light a few features on the event
/// frame are enough, in the dark, in glare and without frames it takes all it can get. Cameras of a kind share what one
/// alone would have: more views of the same scene should not cost more.
int PacketOdometry::features_wanted(const Channel& channel) const {
  if (channel.camera.modality == Modality::Frames)
    return config_.frame_tracker.detector.max_features / static_cast<int>(low_light_.size());
  const int all = config_.event_tracker.detector.max_features, cameras = static_cast<int>(event_views_.size());
  if (!frames_at_work()) return all / cameras;
  return std::max(config_.health.min_event_features, all - static_cast<int>(carried_by_frames())) / cameras;
}

void PacketOdometry::mark_keyframe(Timestamp t, std::span<const ChannelView> views) {
  const auto timer = timings_.measure("detect");
  for (const ChannelView& view : views) {
    Channel& channel = *view.channel;
    channel.mark_keyframe(view.detect, T_W_B_of(channel), next_feature_, features_wanted(channel));
  }
  last_keyframe_ = t;
  gyro_saturated_ = false;
}

/// Nothing moves before any event camera.
bool PacketOdometry::is_quiet(const Packet& packet) const {
  bool quiet = !event_views_.empty();
  for (std::size_t i = 0; i < event_views_.size(); ++i) quiet = quiet && event_views_[i].quiet(packet.events[i]);
  return quiet;
}

EstimatorResult PacketOdometry::estimate(const Packet& packet, Preintegration motion,
                                         std::span<const ChannelView> views, bool keyframe) {
  const auto timer = timings_.measure("estimate");
  EstimatorInput input{packet.t, std::move(motion), {}, keyframe, is_quiet(packet), depth_.for_factor(packet.t)};
  for (const ChannelView& view : views) {
    view.channel->T_W_Blast = T_W_B_of(*view.channel);
    input.observations.push_back(view.channel->observations());
  }
  EstimatorResult result = estimator_.add(input);
  for (Channel& channel : channels_) channel.tracker.remove(result.outliers);
  if (!estimator_.initialized()) return result;
  const SE3 T_new_old = body_.correct(estimator_.newest());
  if (result.new_frame) {
    world_.restart(T_new_old, body_.now());
    for (Channel& channel : channels_) channel.move(T_new_old);
  }
  calibrate();
  for (const ChannelView& view : views) view.channel->settle(T_W_B_of(*view.channel), keyframe);
  depth_.add_landmarks(packet.t, landmarks_seen_by(channels_.front()));
  return result;
}

/// Frames are what the map is of, where they see enough: the look of an event frame changes with the motion; those of
/// the first camera of the kind. True when the body has been found in it after a loss.
bool PacketOdometry::follow_map(Timestamp t, std::span<const ChannelView> views, const EstimatorResult& result,
                                bool keyframe) {
  if (!estimator_.initialized()) return false;
  // The filter's drift is that of an odometry with a gyro: without, it is a guess as after a loss.
  if (result.new_frame || turned_unseen_) mapper_.restart(world_.T_W_S(), body_.now());
  if (!config_.map.enabled) return false;
  const auto timer = timings_.measure("map");
  bool relocalized = false;
  mapper_.predict(body_.now());
  const Channel* leading = &channels_.front();
  if (is_fused() && channels_[event_views_.size()].carried() >= kFeaturesForMap)
    leading = &channels_[event_views_.size()];
  const auto view = std::ranges::find(views, leading, &ChannelView::channel);
  if (view != views.end()) {
    relocalized = mapper_.localize(t, *view, T_W_B_of(*view->channel));
    if (keyframe) mapper_.keyframe(t, *view, T_W_B_of(*view->channel));
  }
  for (const KeyframeRecord& record : result.marginalized_keyframes) mapper_.take(record);
  world_.move(mapper_.T_M_O());
  return relocalized;
}

void PacketOdometry::load_map(std::string_view bytes) {
  if (mapper_.started()) throw InputError("a map can be loaded only before the first pose");
  const SavedMap map = saved_map_from_bytes(bytes);
  check_fits(map, given_rig_);
  mapper_.load(map);
}

std::optional<std::string> PacketOdometry::save_map() const {
  std::optional<SavedMap> map = mapper_.save();
  if (!map) return std::nullopt;
  for (const auto& [name, modality, model, T_B_C, time_offset] : given_rig_.cameras)
    map->cameras.push_back({name, model.width(), model.height(), model.mean_focal()});
  return to_bytes(*map);
}

FinalTrajectory PacketOdometry::final_trajectory() const {
  FinalTrajectory all = before_, now = mapper_.final_trajectory();
  std::ranges::move(now.poses, std::back_inserter(all.poses));
  std::ranges::move(now.keyframes, std::back_inserter(all.keyframes));
  return all;
}

void PacketOdometry::calibrate() {
  for (std::size_t camera = 0; camera < channels_.size(); ++camera) {
    channels_[camera].camera = rig_.cameras[camera] = estimator_.window().calibrated(camera);
  }
}

void PacketOdometry::update_covariance(Timestamp t) {
  if (covariance_ && t - covariance_at_ < kCovarianceEvery && estimator_.initialized()) return;
  const auto timer = timings_.measure("covariance");
  covariance_.reset();
  covariance_at_ = t;
  if (const std::optional<Matrix15d> P = estimator_.covariance()) {
    const Eigen::Matrix3d R_W_S = world_.T_W_S().R();
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

std::optional<Eigen::Matrix4d> PacketOdometry::calibration_covariance(const std::string& camera) const {
  const auto found = std::ranges::find(rig_.cameras, camera, &RigCamera::name);
  if (found == rig_.cameras.end()) return std::nullopt;
  return estimator_.calibration_covariance(static_cast<std::size_t>(found - rig_.cameras.begin()));
}

}  // namespace edged
