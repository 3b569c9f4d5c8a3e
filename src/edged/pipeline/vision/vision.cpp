// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/vision.hpp"

#include <algorithm>
#include <utility>

#include "edged/events/expected_frame.hpp"

namespace edged {
namespace {

/// After this time without a frame, event frames keep all their features.
constexpr Duration kFramesMissing = std::chrono::milliseconds(300);

/// The features of one of several cameras of a kind, whose budget is a third larger than that of one: more views of the
/// same scene should not cost much more, but observe less of it with half of the features each.
int part_of_budget(int features, std::size_t cameras) {
  return cameras == 1 ? features : features * 4 / (3 * static_cast<int>(cameras));
}

}  // namespace

Vision::Vision(const Rig& cameras, const OdometryConfig& config, Inference inference, StageTimings& timings)
    : config_(config), inference_(inference), rig_(cameras), timings_(&timings), depth_(fresh_depth()) {
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      event_views_.emplace_back(camera.model, config_);
    } else {
      low_light_.emplace_back(config_.low_light);
    }
  }
  make_channels();
}

void Vision::make_channels() {
  channels_.clear();
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      const CameraModel& ideal = event_views_[channels_.size()].ideal();
      channels_.emplace_back(camera, ideal, config_.event_tracker, config_.alignment, config_.health);
    } else {
      channels_.emplace_back(camera, camera.model, config_.frame_tracker, AlignmentConfig{}, config_.health);
    }
    channels_.back().only_one_of_its_kind =
        std::ranges::count(rig_.cameras, camera.modality, &RigCamera::modality) == 1;
  }
}

void Vision::begin_time() {
  make_channels();
  depth_ = fresh_depth();
  last_keyframe_.reset();
  last_frame_.reset();
  gyro_saturated_ = false;
  landmarks_.reset();
  provisional_ = true;
}

VisionOutput Vision::process(const VisionInput& input) {
  const Packet& packet = input.packet;
  gyro_saturated_ |= !input.gyro_trusted;
  VisionOutput output;
  output.scene_depth = measure_depth(packet);
  output.event_images = render(input, output.scene_depth);
  std::vector<ChannelView> views = views_of(packet, output.event_images);
  for (const ChannelView& view : views) track(view, input, output.scene_depth);
  reject(views, input.body);
  output.keyframe = is_keyframe(input, views);
  if (output.keyframe) mark_keyframe(input, views, output.scene_depth);
  for (const ChannelView& view : views) {
    view.channel->settle(view.channel->T_O_B_now(input.body), output.keyframe);
    output.observations.push_back(view.channel->observations());
  }
  if (landmarks_) discount_shared(output.observations, views, config_.stereo);  // a start takes three images only
  output.images = images_of(views);
  output.events_quiet = is_quiet(packet, output.event_images);
  output.depth = depth_.for_factor(packet.t);
  return output;
}

void Vision::correct(const VisionCorrection& correction, const BodyMotion& body) {
  const Timestamp t = body.now().t;
  for (Channel& channel : channels_) channel.tracker.remove(correction.outliers);
  landmarks_ = correction.landmarks;
  provisional_ = correction.provisional;
  if (!landmarks_) return;
  rig_.cameras = correction.cameras;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    if (correction.T_new_old) channel.move(*correction.T_new_old);
    channel.camera = rig_.cameras[i];
    if (channel.has_image_of(t)) channel.settle(channel.T_O_B_now(body), last_keyframe_ == t);
  }
  depth_.add_landmarks(t, landmarks_seen_by(channels_.front(), body));
  if (correction.ended) landmarks_.reset();
}

std::vector<CameraStep> Vision::describe(Packet packet, const VisionOutput& output) const {
  std::vector<CameraStep> cameras;
  cameras.reserve(channels_.size());  // OpenCV's images may throw when moved: a reallocation would copy the events
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Channel& channel = channels_[i];
    CameraStep camera{.name = channel.camera.name, .modality = channel.camera.modality};
    camera.tracks = channel.tracker.tracks();
    camera.survival_rate = channel.survival_rate();
    if (i < event_views_.size()) {
      camera.image = output.event_images[i].frame;
      camera.rendered = output.event_images[i].rendered;
      camera.events = std::move(packet.events[i].events);
      camera.event_rate_hz = packet.events[i].event_rate_hz;
    } else if (const Frame* frame = packet.find_frame(camera.name)) {
      camera.image = frame->image;
    }
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

double Vision::measure_depth(const Packet& packet) {
  const auto timer = timings_->measure("depth");
  if (!packet.events.empty()) {
    const PacketEvents& first = packet.events.front();
    depth_.add_events(std::span(first.events).last(first.new_events));
  }
  return depth_.at(packet.t);
}

std::vector<EventImage> Vision::render(const VisionInput& input, double scene_depth) {
  std::vector<EventImage> images(event_views_.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto timer = timings_->measure("event_frame");
    EventView& view = event_views_[i];
    const EventsToRender events =
        view.rendered_events(input.packet.events[i], input.body, scene_depth, frames_carry(input.body.now().t));
    if (events.events.empty()) continue;
    const std::optional<DepthGrid> depths = event_depths(i, input.body, scene_depth);
    images[i] = view.render(events, channels_[i].camera, input.body, scene_depth, depths ? &*depths : nullptr);
  }
  return images;
}

/// The landmarks of all cameras, in that one now.
std::vector<SeenDepth> Vision::landmarks_seen_by(const Channel& viewer, const BodyMotion& body) const {
  std::vector<SeenDepth> seen;
  const SE3 T_C_O = viewer.T_O_C(viewer.T_O_B_now(body)).inverse();
  for (const Channel& channel : channels_) {
    const SE3 T_C_last = T_C_O * channel.T_O_C(channel.T_O_Blast);
    for (const Track& track : channel.tracker.tracks()) {
      const std::optional<double> depth = landmark_depth(channel, track.id);
      if (!depth) continue;
      const Eigen::Vector3d p_C = T_C_last * (*depth * track.point.homogeneous());
      if (p_C.z() > 0.0) seen.push_back({p_C.hnormalized(), p_C.z()});
    }
  }
  return seen;
}

/// One depth per event in the same order; nothing if one depth serves for the whole scene, or no other is known.
std::optional<DepthGrid> Vision::event_depths(std::size_t camera, const BodyMotion& body, double scene_depth) const {
  if (config_.event_frame.depth != EventDepth::Landmarks || !landmarks_) return std::nullopt;
  const CameraModel& ideal = event_views_[camera].ideal();
  std::vector<DepthSample> samples;
  for (const SeenDepth& seen : landmarks_seen_by(channels_[camera], body)) {
    const Eigen::Vector3d p_C = seen.depth_m * seen.point.homogeneous();
    if (const auto pixel = ideal.project(p_C)) samples.push_back({*pixel, seen.depth_m});
  }
  return DepthGrid(ideal.width(), ideal.height(), config_.event_frame.depth_grid, samples, scene_depth);
}

/// The cameras with an image in the packet.
std::vector<ChannelView> Vision::views_of(const Packet& packet, std::span<const EventImage> event_images) {
  std::vector<ChannelView> views;
  for (std::size_t i = 0; i < event_images.size(); ++i) {
    const EventImage& image = event_images[i];
    if (!image.frame.empty() && !image.noise)
      views.push_back({&channels_[i], image.track, image.detect, image.increments, image.covered});
  }
  for (std::size_t i = event_images.size(); i < channels_.size(); ++i) {
    const Frame* frame = packet.find_frame(channels_[i].camera.name);
    if (frame == nullptr) continue;
    const cv::Mat image = low_light_[i - event_images.size()](frame->image);
    views.push_back({&channels_[i], image, image});
    last_frame_ = packet.t;
  }
  return views;
}

void Vision::track(const ChannelView& view, const VisionInput& input, double scene_depth) {
  Channel& channel = *view.channel;
  const auto timer = timings_->measure(channel.camera.modality == Modality::Events ? "track_events" : "track_frames");
  TrackPrediction prediction;
  prediction.scene_depth = scene_depth;
  prediction.depth = [&](FeatureId id) { return landmark_depth(channel, id); };
  // With one reference patch all errors of a track correlate, which the thresholds of initialization do not model: with
  // events alone 3 of 72 initializations have a wrong scale, 1 without.
  prediction.reference_patches = !provisional_;
  prediction.increments = {view.increments, to_seconds(view.covered) / channel.since_last_image_s(input.packet.t)};
  channel.track(view.track, input.packet.t, channel.T_O_B_now(input.body), std::move(prediction),
                channel.camera.modality == Modality::Frames && landmarks_ ? input.packet.lamp() : std::nullopt);
}

void Vision::reject(std::span<const ChannelView> views, const BodyMotion& body) {
  const auto timer = timings_->measure("reject");
  for (auto view = views.begin(); view != views.end(); ++view) {
    for (auto other = views.begin(); other != view; ++other) drop_mismatches(*other, *view, body, config_.stereo);
  }
  for (const ChannelView& view : views) view.channel->reject(view.channel->T_O_B_now(body), !gyro_saturated_);
}

bool Vision::is_keyframe(const VisionInput& input, std::span<const ChannelView> views) const {
  const Packet& packet = input.packet;
  const Channel* leader = leading_channel(views);
  if (leader == nullptr) return false;
  // With both cameras a keyframe waits for the next frame, so that both have it.
  const bool frame_due =
      is_fused() && packet.frames.empty() && last_frame_ && packet.t - *last_frame_ < std::chrono::milliseconds(60);
  if (frame_due) return false;
  SinceKeyframe since;
  since.any = last_keyframe_.has_value();
  if (!since.any) return true;
  since.time = packet.t - *last_keyframe_;
  // Only the camera with most tracks: features on event frames drift and end earlier, and would cause keyframes that
  // good frames do not need.
  const Eigen::Matrix3d R_Ckf_C = leader->since_keyframe(leader->T_O_B_now(input.body));
  since.tracks = leader->tracker.since_keyframe(R_Ckf_C);
  since.rotation_rad = so3::log(Eigen::Quaterniond(R_Ckf_C)).norm();
  return keyframe_reason(since, config_.keyframes) != KeyframeReason::None;
}

void Vision::mark_keyframe(const VisionInput& input, std::span<ChannelView> views, double scene_depth) {
  const auto timer = timings_->measure("detect");
  expect_events(views, input.body, scene_depth);
  for (const ChannelView& to : views) {
    for (const ChannelView& from : views) {
      if (to.channel->camera.modality == Modality::Events && from.channel->camera.modality == Modality::Frames)
        share(from, to, input.body);
    }
  }
  for (auto view = views.begin(); view != views.end(); ++view) {
    for (auto other = views.begin(); other != view; ++other) share(*other, *view, input.body);
    view->channel->tracker.detect(view->detect, next_feature_, features_wanted(*view->channel, input.body.now().t));
    for (auto other = views.begin(); other != view; ++other) share(*view, *other, input.body);
  }
  for (const ChannelView& view : views) view.channel->mark_keyframe(view.channel->T_O_B_now(input.body));
  last_keyframe_ = input.packet.t;
  gyro_saturated_ = false;
}

/// Frames as the event cameras that can share features with them would see their scene. What these cameras follow
/// already comes first: features of frames are more accurate than those that an event frame would get of its own.
void Vision::expect_events(std::span<ChannelView> views, const BodyMotion& body, double scene_depth) const {
  constexpr Duration kSoon = std::chrono::milliseconds(5);
  for (ChannelView& view : views) {
    const Channel& channel = *view.channel;
    if (channel.camera.modality != Modality::Frames) continue;
    if (std::ranges::none_of(views, [&](const ChannelView& other) {
          return other.channel->camera.modality == Modality::Events &&
                 can_share(channel, *other.channel, config_.stereo);
        }))
      continue;
    std::optional<SE3> T_later_now;
    if (body.started())
      T_later_now = channel.T_O_C(body.moved_on(channel.camera.time_offset + kSoon)).inverse() *
                    channel.T_O_C(channel.T_O_B_now(body));
    view.as_events = expected_event_frame(view.track, channel.tracker.camera(), T_later_now, scene_depth);
  }
}

void Vision::share(const ChannelView& from, const ChannelView& to, const BodyMotion& body) {
  const auto depth = [this](const Channel& channel, FeatureId id) { return landmark_depth(channel, id); };
  share_features(from, to, body, depth, features_wanted(*to.channel, body.now().t), config_.stereo);
}

std::optional<double> Vision::landmark_depth(const Channel& channel, FeatureId id) const {
  if (!landmarks_) return std::nullopt;
  const auto& of_camera = landmarks_->at(static_cast<std::size_t>(&channel - channels_.data()));
  const auto landmark = of_camera.find(id);
  return landmark == of_camera.end() ? std::nullopt : std::optional(landmark->second);
}

double Vision::carried_by_frames() const {
  double carried = 0.0;
  for (std::size_t i = event_views_.size(); i < channels_.size(); ++i) carried += channels_[i].carried();
  return carried;
}

bool Vision::frames_at_work(Timestamp t) const {
  return is_fused() && last_frame_ && t - *last_frame_ < kFramesMissing;
}

/// Whether frames have enough features for event frames to keep few.
bool Vision::frames_carry(Timestamp t) const {
  return frames_at_work(t) && carried_by_frames() >= config_.health.min_event_features;
}

/// Frames give more accurate observations than events, if they show the feature: in good light a few features on the
/// event frame are enough; in the dark, in glare and without frames it keeps all.
int Vision::features_wanted(const Channel& channel, Timestamp t) const {
  if (channel.camera.modality == Modality::Frames)
    return part_of_budget(config_.frame_tracker.detector.max_features, low_light_.size());
  const int all = config_.event_tracker.detector.max_features;
  if (!frames_at_work(t)) return part_of_budget(all, event_views_.size());
  return part_of_budget(std::max(config_.health.min_event_features, all - static_cast<int>(carried_by_frames())),
                        event_views_.size());
}

bool Vision::is_quiet(const Packet& packet, std::span<const EventImage> event_images) const {
  bool quiet = !event_views_.empty();
  for (std::size_t i = 0; i < event_views_.size(); ++i)
    quiet = quiet && (event_images[i].noise || event_views_[i].quiet(packet.events[i]));
  return quiet;
}

std::vector<TrackedImage> Vision::images_of(std::span<const ChannelView> views) const {
  std::vector<TrackedImage> images;
  for (const Channel& channel : channels_) {
    const FeatureTracker& tracker = channel.tracker;
    images.push_back({channel.camera.name, tracker.camera(), {}, tracker.tracks(), channel.survival_rate()});
    const auto view = std::ranges::find(views, &channel, &ChannelView::channel);
    if (view != views.end()) images.back().image = view->track;
  }
  return images;
}

}  // namespace edged
