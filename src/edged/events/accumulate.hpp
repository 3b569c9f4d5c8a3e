// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The event frame: motion-compensated events summed into an image of fixed scaling, ready for detection and tracking.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "edged/events/warp.hpp"
#include "edged/options/events.hpp"

namespace edged {

/// Renders event frames of one camera, reusing its buffers. Polarity is ignored. The scaling does not depend on the
/// content, so that brightness is constant from frame to frame.
class EventFrameRenderer {
 public:
  EventFrameRenderer(UndistortTable table, const EventFrameConfig& config);

  /// The sum of the bilinear weights of the warped events, CV_32FC1, undistorted, size of the table. Valid until the
  /// next call. depth: z-depth of the scene [m]; depths: that of every event, in its place.
  cv::Mat accumulate(std::span<const Event> events, const CameraMotion& motion, double depth,
                     const DepthGrid* depths = nullptr);

  /// accumulate, then blur and scale to CV_8UC1; a new image each time. weight: the number of events that each one
  /// represents.
  cv::Mat render(std::span<const Event> events, const CameraMotion& motion, double depth,
                 const DepthGrid* depths = nullptr, double weight = 1.0);

  /// The undistorted camera of the images.
  const CameraModel& camera() const { return table_.ideal(); }

 private:
  UndistortTable table_;
  EventFrameConfig config_;
  cv::Mat padded_;  ///< CV_32FC1, one pixel of border for the weights of events just outside
  cv::Mat blurred_;
};

/// One event frame, for a single use.
cv::Mat render_event_frame(std::span<const Event> events, const CameraMotion& motion, double depth,
                           const UndistortTable& table, const EventFrameConfig& config);

}  // namespace edged
