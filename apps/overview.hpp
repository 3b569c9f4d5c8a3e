// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// overview.png: what the sensors saw at the run's liveliest moment, and the path from the side that shows most of it.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "edged/odometry.hpp"
#include "edged/state.hpp"

namespace edged {

/// The images of the moment with the highest event rate (without events: with the most tracks).
class LiveliestMoment {
 public:
  void consider(const Step& step);

  const cv::Mat& frame() const { return frame_; }              ///< CV_8UC1, empty without frames
  const cv::Mat& event_frame() const { return event_frame_; }  ///< CV_8UC1, empty without events

 private:
  double score_ = -1.0;
  cv::Mat frame_, event_frame_;
};

struct OverviewContent {
  std::string title;
  LiveliestMoment moment;
  Trajectory estimate;
  Trajectory truth;  ///< in the world of the estimate; empty where there is none
};

/// CV_8UC3. Both paths are drawn in the plane of the two longest sides of the estimate's bounding box, one scale for
/// both axes.
cv::Mat draw_overview(const OverviewContent& content);

}  // namespace edged
