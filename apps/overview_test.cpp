// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "overview.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace edged {
namespace {

Packet packet_with(double rate_hz, bool frame) {
  Packet packet;
  packet.event_rate_hz = rate_hz;
  if (frame) packet.frame = Frame{{}, "frames", cv::Mat(18, 24, CV_8UC1, cv::Scalar(rate_hz))};
  return packet;
}

OdometryOutput good() {
  OdometryOutput output;
  output.status = TrackingStatus::Good;
  return output;
}

TEST(LiveliestMoment, IsThatOfTheHighestEventRateWithAFrame) {
  LiveliestMoment moment;
  const cv::Mat events(18, 24, CV_8UC1, cv::Scalar(1));
  moment.consider(packet_with(90, false), good(), events);
  moment.consider(packet_with(10, true), good(), events);
  moment.consider(packet_with(30, true), good(), events);
  moment.consider(packet_with(80, false), good(), events);
  moment.consider(packet_with(20, true), good(), events);
  moment.consider(packet_with(99, true), OdometryOutput{}, events);  // still initializing
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
  content.truth = content.estimate;
  content.moment.consider(packet_with(30, true), good(), cv::Mat(180, 240, CV_8UC1, cv::Scalar(50)));
  const cv::Mat drawn = draw_overview(content);
  EXPECT_EQ(drawn.type(), CV_8UC3);
  EXPECT_GT(drawn.cols, 800);
}

}  // namespace
}  // namespace edged
