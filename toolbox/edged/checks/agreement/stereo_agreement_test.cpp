// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/stereo_agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

/// Events on the edges of an image, within 10 ms.
EventBatch events_of(const Frame& frame) {
  EventBatch batch{frame.camera, {}};
  cv::Mat blurred;
  cv::GaussianBlur(frame.image, blurred, cv::Size(0, 0), 1.0);
  for (int y = 0; y + 1 < blurred.rows; ++y)
    for (int x = 0; x + 1 < blurred.cols; ++x)
      for (int i = 0; i < std::abs(blurred.at<std::uint8_t>(y, x + 1) - blurred.at<std::uint8_t>(y, x)) / 6; ++i)
        batch.events.push_back({frame.t + std::chrono::milliseconds(2 * i), static_cast<std::uint16_t>(x),
                                static_cast<std::uint16_t>(y), true});
  std::ranges::stable_sort(batch.events, {}, &Event::t);
  return batch;
}

/// What is said of some seconds of two cameras 11 cm apart, whose images have these names.
std::vector<std::string> exchanged(const std::string& left, const std::string& right, Modality modality) {
  const PlaneScene scene(davis_like_pinhole(), 2.0);
  const SE3 T_W_right(so3::exp(Eigen::Vector3d(0.01, -0.015, 0.02)), Eigen::Vector3d(0.11, 0.004, -0.01));
  const std::vector<RigCamera> cameras{{"left", modality, scene.camera(), SE3()},
                                       {"right", modality, scene.camera(), T_W_right}};
  StereoAgreement stereo(cameras);
  const auto add = [&](const Frame& frame) {
    modality == Modality::Frames ? stereo.add(frame) : stereo.add(events_of(frame));
    const Timestamp later = frame.t + std::chrono::milliseconds(100);
    if (modality == Modality::Events) stereo.add(EventBatch{frame.camera, {{later, 0, 0, true}}});
  };
  for (const int second : {1, 2}) {
    const Timestamp t = timestamp_from_seconds(second);
    add({t, left, scene.image(SE3())});
    add({t, right, scene.image(T_W_right)});
  }
  return stereo.exchanged();
}

TEST(StereoAgreement, NamesCamerasThatAreExchanged) {
  for (const Modality modality : {Modality::Frames, Modality::Events})
    EXPECT_EQ(exchanged("right", "left", modality), std::vector<std::string>{"left and right"});
}

TEST(StereoAgreement, SaysNothingOfTwoCamerasAsCalibrated) {
  for (const Modality modality : {Modality::Frames, Modality::Events})
    EXPECT_TRUE(exchanged("left", "right", modality).empty());
}

}  // namespace
}  // namespace edged
