// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Every option of the odometry, grouped by the part that owns it.
#pragma once

#include "edged/core/config.hpp"
#include "edged/depth/depth_config.hpp"
#include "edged/estimator/estimator.hpp"
#include "edged/events/accumulate.hpp"
#include "edged/events/enhance.hpp"
#include "edged/frontend/dim_image.hpp"
#include "edged/frontend/keyframe_policy.hpp"
#include "edged/frontend/tracker.hpp"
#include "edged/pipeline/channel.hpp"
#include "edged/pipeline/packetizer.hpp"
#include "edged/pipeline/tracking_status.hpp"

namespace edged {

struct OdometryConfig {
  OdometryConfig();

  PacketizerConfig packets;
  EventFrameConfig event_frame;
  EnhanceConfig enhance;
  bool enhance_detect = true;  ///< find corners on the enhanced event frame
  bool enhance_track = false;  ///< follow them on it too
  AlignmentConfig alignment;   ///< of the event frames
  HealthConfig health;         ///< of each camera
  DimImageConfig dim_frames;   ///< standard frames in the dark
  TrackerConfig event_tracker;
  TrackerConfig frame_tracker;
  KeyframeConfig keyframes;
  DepthConfig depth;
  EstimatorConfig estimator;
  double quiet_rate_per_pixel = 1.2;  ///< event rate [1/s/px] below which nothing moves in view
  double max_travel_px = 5.0;         ///< image motion by translation over the events of one event frame
  double min_events_per_pixel = 0.1;  ///< a packet with fewer events draws no event frame
  StatusConfig status;

  void visit(ConfigFields& fields);

  /// Throws InputError with the reason when an option is out of its range or contradicts another.
  void validate() const;
};

}  // namespace edged
