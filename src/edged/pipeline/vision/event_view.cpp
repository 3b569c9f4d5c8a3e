// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/event_view.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "edged/camera/undistort.hpp"
#include "edged/events/enhance.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

/// The poses from the last one not after t on, at least two. A single twist (Eq. 1) covers only the time of the events.
std::span<const StampedPose> covering(const std::vector<StampedPose>& poses, Timestamp t) {
  std::size_t first = poses.size() - 2;
  while (first > 0 && poses[first].t > t) --first;
  return std::span(poses).subspan(first);
}

}  // namespace

EventView::EventView(const CameraModel& camera, const OdometryConfig& config)
    : renderer_(UndistortTable(camera, ideal_pinhole(camera)), config.event_frame),
      enhance_(config.enhance),
      enhance_track_(config.enhance_track),
      enhance_detect_(config.enhance_detect),
      max_age_s_(config.packets.max_age_s),
      min_events_(static_cast<std::size_t>(std::ceil(config.min_events_per_pixel * pixels()))),
      subsampling_(std::max(1, static_cast<int>(camera.width() / kPipelineTuning.subsampled_width_px))) {}

bool EventView::is_static(const PacketEvents& events, Timestamp t) {
  const double forgetting = std::exp(to_seconds(t - rated_at_) / kPipelineTuning.least_rate_memory_s);
  // In this order: after hours without an event the product is no number.
  least_rate_hz_ = std::min(events.event_rate_hz, least_rate_hz_ * forgetting);
  rated_at_ = t;
  const double least = std::max(least_rate_hz_, kPipelineTuning.noise_rate_per_pixel * pixels());
  return events.event_rate_hz <
         std::min(kPipelineTuning.static_rate_per_pixel * pixels(), kPipelineTuning.static_rate_rise * least);
}

EventsToRender EventView::rendered_events(const PacketEvents& events, const ImuPropagator& body, double scene_depth,
                                          bool subsample) const {
  const std::span<const Event> window = events.window();
  if (window.size() < min_events_ || body.poses().size() < 2) return {};
  const int every = subsample ? subsampling_ : 1;
  if (!body.started()) return {window, every};
  const double parallax_px_per_s = ideal().mean_focal() * body.now().v_O.norm() / scene_depth;
  const double age_s = std::min(kPipelineTuning.max_parallax_px / std::max(parallax_px_per_s, 1e-3), max_age_s_);
  const auto oldest = std::lower_bound(window.begin(), window.end(), body.now().t - duration_from_seconds(age_s),
                                       [](const Event& event, Timestamp t) { return event.t < t; });
  return {window.last(std::max(static_cast<std::size_t>(window.end() - oldest), min_events_)), every};
}

EventImage EventView::render(const EventsToRender& rendered, const RigCamera& camera, const ImuPropagator& body,
                             double scene_depth, const DepthGrid* depths) {
  std::span<const Event> events = rendered.events;
  if (rendered.every > 1) {
    const auto every = static_cast<std::size_t>(rendered.every);
    subsampled_.clear();
    for (std::size_t i = (events.size() - 1) % every; i < events.size(); i += every) subsampled_.push_back(events[i]);
    events = subsampled_;
  }
  const std::span<const StampedPose> poses = covering(body.poses(), events.front().t + camera.time_offset);
  const CameraMotion motion =
      camera_motion(poses, body.extrapolate(camera.time_offset), camera.T_B_C, camera.time_offset);
  EventImage image;
  image.rendered = rendered.events.size();
  const EventFrame rendered_frame = renderer_.render(events, motion, scene_depth, depths, rendered.every);
  image.frame = rendered_frame.image;
  image.increments = rendered_frame.increments;
  image.noise = rendered_frame.structure < kPipelineTuning.min_structure;
  image.covered = events.back().t - events.front().t;
  const cv::Mat enhanced = enhance(image.frame, enhance_);
  image.track = enhance_track_ ? enhanced : image.frame;
  image.detect = enhance_detect_ ? enhanced : image.frame;
  return image;
}

}  // namespace edged
