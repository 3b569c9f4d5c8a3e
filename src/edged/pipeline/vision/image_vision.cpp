// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/image_vision.hpp"

#include <algorithm>
#include <utility>

#include "edged/events/expected_frame.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

/// The features of one of several cameras of a kind, whose budget is a third larger than that of one: more views of the
/// same scene should not cost much more, but observe less of it with half of the features each.
int part_of_budget(int features, std::size_t cameras) {
  return cameras == 1 ? features : features * 4 / (3 * static_cast<int>(cameras));
}

}  // namespace

ImageVision::ImageVision(const Rig& cameras, const OdometryConfig& config, Inference inference, StageTimings& timings)
    : config_(config), inference_(inference), rig_(cameras), timings_(&timings), depth_(fresh_depth()) {
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      event_views_.emplace_back(camera.model, config_);
    } else {
      low_light_.emplace_back(config_.low_light);
    }
  }
  make_trackers();
}

void ImageVision::make_trackers() {
  trackers_.clear();
  for (const RigCamera& camera : rig_.cameras) {
    if (camera.modality == Modality::Events) {
      const CameraModel& ideal = event_views_[trackers_.size()].ideal();
      trackers_.emplace_back(camera, ideal, config_.event_tracker, config_.alignment, config_.health);
    } else {
      trackers_.emplace_back(camera, camera.model, config_.frame_tracker, AlignmentConfig{}, config_.health);
    }
    trackers_.back().only_one_of_its_kind =
        std::ranges::count(rig_.cameras, camera.modality, &RigCamera::modality) == 1;
  }
}

void ImageVision::begin_epoch() {
  make_trackers();
  depth_ = fresh_depth();
  last_keyframe_.reset();
  last_frame_.reset();
  gyro_saturated_ = false;
  landmarks_.reset();
  provisional_ = true;
}

VisionOutput ImageVision::process(const VisionInput& input) {
  const Packet& packet = input.packet;
  gyro_saturated_ |= !input.gyro_trusted;
  VisionOutput output;
  output.scene_depth = measure_depth(packet);
  output.event_images = render(input, output.scene_depth);
  std::vector<CameraImage> views = views_of(packet, output.event_images);
  for (const CameraImage& view : views) track(view, input, output.scene_depth);
  reject(views, input.body);
  output.keyframe = is_keyframe(input, views);
  if (output.keyframe) mark_keyframe(input, views, output.scene_depth);
  for (const CameraImage& view : views) {
    view.tracker->set_pose(view.tracker->T_O_B_now(input.body), output.keyframe);
    output.observations.push_back(view.tracker->observations());
  }
  if (landmarks_) inflate_correlated(output.observations, views, config_.stereo);  // a start takes three images only
  output.images = images_of(views);
  output.events_static = is_static(packet, output.event_images);
  output.depth = depth_.for_factor(packet.t);
  return output;
}

void ImageVision::correct(const VisionCorrection& correction, const ImuPropagator& body) {
  const Timestamp t = body.now().t;
  for (CameraTracker& tracker : trackers_) tracker.features->remove(correction.outliers);
  landmarks_ = correction.landmarks;
  provisional_ = correction.provisional;
  if (!landmarks_) return;
  rig_.cameras = correction.cameras;
  for (std::size_t i = 0; i < trackers_.size(); ++i) {
    CameraTracker& tracker = trackers_[i];
    if (correction.T_new_old) tracker.move(*correction.T_new_old);
    tracker.camera = rig_.cameras[i];
    if (tracker.has_image_of(t)) tracker.set_pose(tracker.T_O_B_now(body), last_keyframe_ == t);
  }
  depth_.add_landmarks(t, landmarks_seen_by(trackers_.front(), body));
  if (correction.ended) landmarks_.reset();
}

std::vector<CameraStep> ImageVision::describe(Packet packet, const VisionOutput& output) const {
  std::vector<CameraStep> cameras;
  cameras.reserve(trackers_.size());  // OpenCV's images may throw when moved: a reallocation would copy the events
  for (std::size_t i = 0; i < trackers_.size(); ++i) {
    const CameraTracker& tracker = trackers_[i];
    CameraStep camera{.name = tracker.camera.name, .modality = tracker.camera.modality};
    camera.tracks = tracker.features->tracks();
    camera.survival_rate = tracker.survival_rate();
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

double ImageVision::measure_depth(const Packet& packet) {
  const auto timer = timings_->measure("depth");
  if (!packet.events.empty()) {
    const PacketEvents& first = packet.events.front();
    depth_.add_events(std::span(first.events).last(first.new_events));
  }
  return depth_.at(packet.t);
}

std::vector<EventImage> ImageVision::render(const VisionInput& input, double scene_depth) {
  std::vector<EventImage> images(event_views_.size());
  // The motion of an event frame's events is compensated by the gyro: in a gap, features on it would measure what was
  // assumed, and frames are better without them.
  if (input.body.gap_s() > 0.0 && frames_sufficient(input.body.now().t)) return images;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto timer = timings_->measure("event_frame");
    EventView& view = event_views_[i];
    const EventsToRender events =
        view.rendered_events(input.packet.events[i], input.body, scene_depth, frames_sufficient(input.body.now().t));
    if (events.events.empty()) continue;
    const std::optional<DepthGrid> depths = event_depths(i, input.body, scene_depth);
    images[i] = view.render(events, trackers_[i].camera, input.body, scene_depth, depths ? &*depths : nullptr);
  }
  return images;
}

/// The landmarks of all cameras, in that one now.
std::vector<SeenDepth> ImageVision::landmarks_seen_by(const CameraTracker& viewer, const ImuPropagator& body) const {
  std::vector<SeenDepth> seen;
  const SE3 T_C_O = viewer.T_O_C(viewer.T_O_B_now(body)).inverse();
  for (const CameraTracker& tracker : trackers_) {
    const SE3 T_C_last = T_C_O * tracker.T_O_C(tracker.T_O_Blast);
    for (const Track& track : tracker.features->tracks()) {
      const std::optional<double> depth = landmark_depth(tracker, track.id);
      if (!depth) continue;
      const Eigen::Vector3d p_C = T_C_last * (*depth * track.point.homogeneous());
      if (p_C.z() > 0.0) seen.push_back({p_C.hnormalized(), p_C.z()});
    }
  }
  return seen;
}

/// One depth per event in the same order; nothing if one depth serves for the whole scene, or no other is known.
std::optional<DepthGrid> ImageVision::event_depths(std::size_t camera, const ImuPropagator& body,
                                                   double scene_depth) const {
  if (config_.event_frame.depth != EventDepth::Landmarks || !landmarks_) return std::nullopt;
  const CameraModel& ideal = event_views_[camera].ideal();
  std::vector<DepthSample> samples;
  for (const SeenDepth& seen : landmarks_seen_by(trackers_[camera], body)) {
    const Eigen::Vector3d p_C = seen.depth_m * seen.point.homogeneous();
    if (const auto pixel = ideal.project(p_C)) samples.push_back({*pixel, seen.depth_m});
  }
  return DepthGrid(ideal.width(), ideal.height(), DepthGridSettings{}, samples, scene_depth);
}

/// The cameras with an image in the packet.
std::vector<CameraImage> ImageVision::views_of(const Packet& packet, std::span<const EventImage> event_images) {
  std::vector<CameraImage> views;
  for (std::size_t i = 0; i < event_images.size(); ++i) {
    const EventImage& image = event_images[i];
    if (!image.frame.empty() && !image.noise)
      views.push_back({&trackers_[i], image.track, image.detect, image.increments, image.covered});
  }
  for (std::size_t i = event_images.size(); i < trackers_.size(); ++i) {
    const Frame* frame = packet.find_frame(trackers_[i].camera.name);
    if (frame == nullptr) continue;
    const cv::Mat image = low_light_[i - event_images.size()](frame->image);
    views.push_back({&trackers_[i], image, image});
    last_frame_ = packet.t;
  }
  return views;
}

void ImageVision::track(const CameraImage& view, const VisionInput& input, double scene_depth) {
  CameraTracker& tracker = *view.tracker;
  const auto timer = timings_->measure(tracker.camera.modality == Modality::Events ? "track_events" : "track_frames");
  TrackPrediction prediction;
  prediction.scene_depth = scene_depth;
  prediction.depth = [&](FeatureId id) { return landmark_depth(tracker, id); };
  // With one reference patch all errors of a track correlate, which the thresholds of initialization do not model: with
  // events alone 3 of 72 initializations have a wrong scale, 1 without.
  prediction.reference_patches = !provisional_;
  prediction.increments = {view.increments, to_seconds(view.covered) / tracker.since_last_image_s(input.packet.t)};
  tracker.track(view.track, input.packet.t, tracker.T_O_B_now(input.body), std::move(prediction),
                tracker.camera.modality == Modality::Frames && landmarks_ ? input.packet.lamp() : std::nullopt);
}

void ImageVision::reject(std::span<const CameraImage> views, const ImuPropagator& body) {
  const auto timer = timings_->measure("reject");
  for (auto view = views.begin(); view != views.end(); ++view) {
    for (auto other = views.begin(); other != view; ++other) drop_mismatches(*other, *view, body, config_.stereo);
  }
  for (const CameraImage& view : views) view.tracker->reject(view.tracker->T_O_B_now(body), !gyro_saturated_);
}

bool ImageVision::is_keyframe(const VisionInput& input, std::span<const CameraImage> views) const {
  const Packet& packet = input.packet;
  const CameraTracker* leader = leading_tracker(views);
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
  since.tracks = leader->features->since_keyframe(R_Ckf_C);
  since.rotation_rad = so3::log(Eigen::Quaterniond(R_Ckf_C)).norm();
  return keyframe_due(since, config_.keyframes);
}

void ImageVision::mark_keyframe(const VisionInput& input, std::span<CameraImage> views, double scene_depth) {
  const auto timer = timings_->measure("detect");
  expect_events(views, input.body, scene_depth);
  for (const CameraImage& to : views) {
    for (const CameraImage& from : views) {
      if (to.tracker->camera.modality == Modality::Events && from.tracker->camera.modality == Modality::Frames)
        match_across(from, to, input.body);
    }
  }
  for (auto view = views.begin(); view != views.end(); ++view) {
    for (auto other = views.begin(); other != view; ++other) match_across(*other, *view, input.body);
    view->tracker->features->detect(view->detect, next_feature_, features_wanted(*view->tracker, input.body.now().t));
    for (auto other = views.begin(); other != view; ++other) match_across(*view, *other, input.body);
  }
  for (const CameraImage& view : views) view.tracker->mark_keyframe(view.tracker->T_O_B_now(input.body));
  last_keyframe_ = input.packet.t;
  gyro_saturated_ = false;
}

/// Frames as the event cameras that can share features with them would see their scene. What these cameras follow
/// already comes first: features of frames are more accurate than those that an event frame would get of its own.
void ImageVision::expect_events(std::span<CameraImage> views, const ImuPropagator& body, double scene_depth) const {
  constexpr Duration kSoon = std::chrono::milliseconds(5);
  for (CameraImage& view : views) {
    const CameraTracker& tracker = *view.tracker;
    if (tracker.camera.modality != Modality::Frames) continue;
    if (std::ranges::none_of(views, [&](const CameraImage& other) {
          return other.tracker->camera.modality == Modality::Events &&
                 can_match(tracker, *other.tracker, config_.stereo);
        }))
      continue;
    std::optional<SE3> T_later_now;
    if (body.started())
      T_later_now = tracker.T_O_C(body.extrapolate(tracker.camera.time_offset + kSoon)).inverse() *
                    tracker.T_O_C(tracker.T_O_B_now(body));
    view.as_events = expected_event_frame(view.track, tracker.features->camera(), T_later_now, scene_depth);
  }
}

void ImageVision::match_across(const CameraImage& from, const CameraImage& to, const ImuPropagator& body) {
  const auto depth = [this](const CameraTracker& tracker, FeatureId id) { return landmark_depth(tracker, id); };
  match_across_cameras(from, to, body, depth, features_wanted(*to.tracker, body.now().t), config_.stereo);
}

std::optional<double> ImageVision::landmark_depth(const CameraTracker& tracker, FeatureId id) const {
  if (!landmarks_) return std::nullopt;
  const auto& of_camera = landmarks_->at(static_cast<std::size_t>(&tracker - trackers_.data()));
  const auto landmark = of_camera.find(id);
  return landmark == of_camera.end() ? std::nullopt : std::optional(landmark->second);
}

double ImageVision::effective_frame_tracks() const {
  double effective_tracks = 0.0;
  for (std::size_t i = event_views_.size(); i < trackers_.size(); ++i)
    effective_tracks += trackers_[i].effective_tracks();
  return effective_tracks;
}

bool ImageVision::frames_available(Timestamp t) const {
  return is_fused() && last_frame_ && t - *last_frame_ < kPipelineTuning.frames_missing_after;
}

/// Whether frames have enough features for event frames to keep few.
bool ImageVision::frames_sufficient(Timestamp t) const {
  return frames_available(t) && effective_frame_tracks() >= config_.health.min_event_features;
}

/// Frames give more accurate observations than events, if they show the feature: in good light a few features on the
/// event frame are enough; in the dark, in glare and without frames it keeps all.
int ImageVision::features_wanted(const CameraTracker& tracker, Timestamp t) const {
  if (tracker.camera.modality == Modality::Frames)
    return part_of_budget(config_.frame_tracker.detector.max_features, low_light_.size());
  const int all = config_.event_tracker.detector.max_features;
  if (!frames_available(t)) return part_of_budget(all, event_views_.size());
  return part_of_budget(std::max(config_.health.min_event_features, all - static_cast<int>(effective_frame_tracks())),
                        event_views_.size());
}

bool ImageVision::is_static(const Packet& packet, std::span<const EventImage> event_images) {
  bool all = !event_views_.empty();
  for (std::size_t i = 0; i < event_views_.size(); ++i) {
    const bool few = event_views_[i].is_static(packet.events[i], packet.t);
    all = all && (event_images[i].noise || few);
  }
  return all;
}

std::vector<TrackedImage> ImageVision::images_of(std::span<const CameraImage> views) const {
  std::vector<TrackedImage> images;
  for (const CameraTracker& tracker : trackers_) {
    const FeatureTracker& features = *tracker.features;
    images.push_back({tracker.camera.name, features.camera(), {}, features.tracks(), tracker.survival_rate()});
    const auto view = std::ranges::find(views, &tracker, &CameraImage::tracker);
    if (view != views.end()) images.back().image = view->track;
  }
  return images;
}

}  // namespace edged
