// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The event frame of a packet: selection, rendering and enhancement of its events.
#pragma once

#include <limits>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "edged/events/accumulate.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/pipeline/localization/imu_propagator.hpp"

namespace edged {

/// One event frame. All images are empty when there were too few events for one.
struct EventImage {
  cv::Mat frame;          ///< motion-compensated, CV_8UC1, undistorted
  bool noise = false;     ///< it shows noise of the pixels alone: consecutive frames share events, and noise is tracked
  cv::Mat increments;     ///< changes of the brightness (EventFrame)
  Duration covered = {};  ///< from the first to the last of its events
  cv::Mat track, detect;  ///< `frame`, or enhanced (Algorithm 1): features are tracked on one, detected on the other
  std::size_t rendered = 0;  ///< events that it is rendered from, the newest of the packet
};

/// The events that an event frame is rendered from: every `every`-th from the newest on, weighted by `every`.
struct EventsToRender {
  std::span<const Event> events;
  int every = 1;
};

class EventView {
 public:
  EventView(const CameraModel& camera, const OdometryConfig& config);

  /// Fewer events than any motion would cause, and not many more than a few seconds before: in little light
  /// slow motion causes few, too. Called with every packet.
  bool is_static(const PacketEvents& events, Timestamp t);
  /// The events of the window for a frame: fewer in fast translation, where the warp blurs points away from the one
  /// scene depth (z, [m]). Rotation does not matter, as its warp does not depend on depth. body: predicted, at the time
  /// of the packet. Empty if there are too few. subsample: a wide sensor may use a part of its events, with a noisier
  /// frame.
  EventsToRender rendered_events(const PacketEvents& events, const ImuPropagator& body, double scene_depth,
                                 bool subsample) const;
  /// rendered: not empty; camera: with online calibration; depths: one per event in the same order, null: scene_depth
  /// for all.
  EventImage render(const EventsToRender& rendered, const RigCamera& camera, const ImuPropagator& body,
                    double scene_depth, const DepthGrid* depths);

  /// The undistorted camera of the images.
  const CameraModel& ideal() const { return renderer_.camera(); }

 private:
  double pixels() const { return static_cast<double>(ideal().width()) * ideal().height(); }

  EventFrameRenderer renderer_;
  EnhanceConfig enhance_;
  bool enhance_track_, enhance_detect_;
  double max_age_s_;
  std::size_t min_events_;
  int subsampling_;
  double least_rate_hz_ = std::numeric_limits<double>::infinity();  ///< of events, in the last seconds
  Timestamp rated_at_ = {};
  std::vector<Event> subsampled_;  ///< kept to reuse its memory
};

}  // namespace edged
