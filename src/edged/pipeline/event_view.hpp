// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What an event camera shows of a packet: which of its events are rendered, where, and how the frame is enhanced.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "edged/events/accumulate.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/body_motion.hpp"
#include "edged/pipeline/packet.hpp"

namespace edged {

/// One event frame. All images are empty when there were too few events for one.
struct EventImage {
  cv::Mat frame;             ///< motion-compensated, CV_8UC1, undistorted
  cv::Mat track, detect;     ///< the same, or enhanced (Algorithm 1): features are followed on one, found on the other
  std::size_t rendered = 0;  ///< events it is of, the newest of the packet
};

/// Which events an event frame is rendered of: each `every`-th from the newest on, standing for as many.
struct EventsToRender {
  std::span<const Event> events;
  int every = 1;
};

class EventView {
 public:
  EventView(const CameraModel& camera, const OdometryConfig& config);

  /// Fewer events than anything that moves would make.
  bool quiet(const PacketEvents& events) const;
  /// Those of the window that make a frame: shortened when the body moves fast, as over a long way the warp
  /// smears what does not lie at the scene's one depth (z, [m]). Rotation does not count, its warp knows no depth.
  /// body: at the time of their packet, as predicted. Empty when there are too few. thin: a wide sensor's picture may
  /// be noisier than its events allow.
  EventsToRender rendered_events(const PacketEvents& events, const BodyMotion& body, double scene_depth,
                                 bool thin) const;
  /// rendered: not empty; camera: as calibrated so far; depths: that of every event in its place, null: scene_depth for
  /// all.
  EventImage render(const EventsToRender& rendered, const RigCamera& camera, const BodyMotion& body, double scene_depth,
                    const DepthGrid* depths);

  /// The undistorted camera of the images.
  const CameraModel& ideal() const { return renderer_.camera(); }

 private:
  double pixels() const { return static_cast<double>(ideal().width()) * ideal().height(); }

  EventFrameRenderer renderer_;
  EnhanceConfig enhance_;
  bool enhance_track_, enhance_detect_;
  double quiet_rate_per_pixel_, max_travel_px_, max_age_s_;
  std::size_t least_events_;
  int thinned_every_;
  std::vector<Event> thinned_;  ///< kept for its memory
};

}  // namespace edged
