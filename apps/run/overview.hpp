// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// overview.png: images at the moment with the highest event rate, the path from above and from the side, the error over
// time, and problems in red.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/step_facts.hpp"
#include "edged/odometry.hpp"
#include "edged/state.hpp"

namespace edged {

/// The images at the moment with the highest event rate, except bursts far above that of the last second (without
/// events: with the most tracks); among Good steps, if there are any.
class LiveliestMoment {
 public:
  void consider(const Step& step);

  const cv::Mat& frame() const { return frame_; }              ///< CV_8UC1, empty without frames
  const cv::Mat& event_frame() const { return event_frame_; }  ///< CV_8UC1, empty without events

 private:
  double score_ = -2.0;
  double usual_rate_hz_ = 0.0;  ///< mean of about the last second
  std::optional<Timestamp> last_;
  cv::Mat frame_, event_frame_;
};

struct OverviewContent {
  std::string title;
  std::string wrong;  ///< problems, in red; may be empty
  LiveliestMoment moment;
  Trajectory estimate;          ///< in the world of the truth, where there is one
  Trajectory truth;             ///< empty where there is none
  std::vector<double> error_m;  ///< of each pose of the estimate, NaN where it is not known; empty without a truth
  std::vector<StatusChange> changes;  ///< shades times that were not Good
  Timestamp end;                      ///< of the last of them
};

/// CV_8UC3. Both planes have one scale for all axes, and hold estimate and truth.
cv::Mat draw_overview(const OverviewContent& content);

}  // namespace edged
