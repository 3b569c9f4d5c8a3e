// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/overview.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace edged {
namespace {

/// Its first pixel is the rate; the right half is white where the lens is open.
cv::Mat frame_of(double rate_hz, bool covered) {
  cv::Mat image(18, 24, CV_8UC1, cv::Scalar(rate_hz));
  if (!covered) image.colRange(12, 24) = cv::Scalar(255);
  return image;
}

Step good_step(double rate_hz, bool frame, bool covered = false) {
  Step step;
  step.status = TrackingStatus::Good;
  step.cameras = {{.name = "events",
                   .modality = Modality::Events,
                   .image = cv::Mat(18, 24, CV_8UC1, cv::Scalar(1)),
                   .event_rate_hz = rate_hz},
                  {.name = "frames", .image = frame ? frame_of(rate_hz, covered) : cv::Mat()}};
  return step;
}

TEST(LiveliestMoment, IsThatOfTheHighestEventRateWithAFrameButNoFlash) {
  LiveliestMoment moment;
  moment.consider(good_step(90, false));
  moment.consider(good_step(10, true));
  moment.consider(good_step(30, true));
  moment.consider(good_step(80, false));
  moment.consider(good_step(20, true));
  Step initializing = good_step(99, true);
  initializing.status = TrackingStatus::Initializing;
  moment.consider(initializing);
  moment.consider(good_step(40, true, true));
  Step flash = good_step(900, true);
  moment.consider(flash);
  EXPECT_EQ(moment.frame().at<unsigned char>(0, 0), 30);
  EXPECT_FALSE(moment.event_frame().empty());
}

TEST(Overview, IsDrawnForEveryKindOfRun) {
  OverviewContent content;
  content.title = "test";
  EXPECT_FALSE(draw_overview(content).empty());  // nothing estimated
  content.estimate = {{timestamp_from_seconds(0), SE3()}};
  EXPECT_FALSE(draw_overview(content).empty());  // one pose: no extent
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p(std::cos(0.1 * i), 0.1, std::sin(0.1 * i));
    content.estimate.push_back({timestamp_from_seconds(i), SE3(Eigen::Quaterniond::Identity(), p)});
  }
  EXPECT_FALSE(draw_overview(content).empty());  // no truth
  content.truth = content.estimate;
  content.error_m.assign(content.estimate.size(), 0.01);
  content.error_m[50] = std::numeric_limits<double>::quiet_NaN();
  content.moment.consider(good_step(30, true));
  const cv::Mat drawn = draw_overview(content);
  EXPECT_EQ(drawn.type(), CV_8UC3);
  EXPECT_GT(drawn.cols, 800);
  const auto has_red = [](const cv::Mat& picture) {
    cv::Mat red;
    cv::inRange(picture, cv::Scalar(0, 0, 150), cv::Scalar(90, 90, 255), red);
    return cv::countNonZero(red) > 0;
  };
  EXPECT_FALSE(has_red(drawn));
  content.wrong = "not to be trusted";
  EXPECT_TRUE(has_red(draw_overview(content)));
}

}  // namespace
}  // namespace edged
