// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The event frame: motion-compensated events summed into an image of fixed scaling, ready for detection and tracking.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "edged/events/warp.hpp"
#include "edged/options/events.hpp"

namespace edged {

/// Both images of the same motion-compensated events, undistorted. The scaling does not depend on the content, so that
/// brightness is constant from frame to frame.
struct EventFrame {
  cv::Mat image;       ///< the events of either polarity, CV_8UC1
  cv::Mat increments;  ///< positive less negative events: the change of the log brightness, CV_8UC1, 128 where none is
  /// Variance of the increments over that of as many independent events at random places: 1 where there is nothing but
  /// noise of the pixels; edges, along which events lie dense and have one polarity, have 3 to 20. 0 without events.
  double structure = 0.0;
};

/// Variance of the values of a one-channel image, 0 for an empty one: well compensated events lie on edges and raise it
/// (Gallego, Rebecq, Scaramuzza, "A Unifying Contrast Maximization Framework for Event Cameras", CVPR 2018).
double image_variance(const cv::Mat& image);

/// Renders event frames of one camera, reusing its buffers.
class EventFrameRenderer {
 public:
  EventFrameRenderer(UndistortTable table, const EventFrameConfig& config);

  /// The sum of the bilinear weights of the warped events of either polarity, CV_32FC1, undistorted, size of the table.
  /// Valid until the next call. depth: z-depth of the scene [m]; depths: that of every event, in its place.
  cv::Mat accumulate(std::span<const Event> events, const CameraMotion& motion, double depth,
                     const DepthGrid* depths = nullptr);

  /// accumulate, then blur and scale; new images each time. weight: the number of events that each one represents.
  EventFrame render(std::span<const Event> events, const CameraMotion& motion, double depth,
                    const DepthGrid* depths = nullptr, double weight = 1.0);

  /// The undistorted camera of the images.
  const CameraModel& camera() const { return table_.ideal(); }

 private:
  /// Blurred and scaled.
  cv::Mat finish(const cv::Mat& sum, double scale, double zero);

  UndistortTable table_;
  EventFrameConfig config_;
  double spread_;  ///< sum of the squares of the weights of one event after the blur, mean over all subpixels
  cv::Mat positive_, negative_;  ///< CV_32FC1, one pixel of border for the weights of events just outside
  cv::Mat sum_, difference_, blurred_;
};

}  // namespace edged
