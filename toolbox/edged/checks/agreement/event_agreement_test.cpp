// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events of a picture that moves, some of them at other pixels than the frames say.
#include "edged/checks/agreement/event_agreement.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace edged {
namespace {

const cv::Size kSensor(240, 180);

std::vector<RigCamera> lens_of_both() {
  const CameraModel model(kSensor.width, kSensor.height, 200, 200, 120, 90, DistortionModel::None, {});
  return {{"frames", Modality::Frames, model, {}, Duration(0)}, {"events", Modality::Events, model, {}, Duration(0)}};
}

/// Discs before a wall.
cv::Mat picture(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int end) { return static_cast<int>(random() % static_cast<unsigned>(end)); };
  cv::Mat image(kSensor, CV_8UC1, cv::Scalar(90));
  for (int i = 0; i < 25; ++i) {
    const int x = below(kSensor.width), y = below(kSensor.height), radius = 5 + below(15), grey = below(256);
    cv::circle(image, {x, y}, radius, cv::Scalar(grey), cv::FILLED);
  }
  return image;
}

/// Frames of one picture with events on the edges of another, whose pixels are at flip(x, y).
template <typename Flip>
EventAgreement shown(const cv::Mat& to_frames, const cv::Mat& to_events, const Flip& flip) {
  cv::Mat edges;
  cv::morphologyEx(to_events, edges, cv::MORPH_GRADIENT, cv::Mat());
  EventAgreement agreement(lens_of_both());
  for (int i = 0; i < 40; ++i) {
    const Timestamp t = timestamp_from_seconds(0.1 * i);
    EventBatch batch{"events", {}};
    for (int y = 0; y < edges.rows; ++y)
      for (int x = 0; x < edges.cols; ++x)
        if (edges.at<std::uint8_t>(y, x) > 0) {
          const auto [to_x, to_y] = flip(x, y);
          batch.events.push_back({t, static_cast<std::uint16_t>(to_x), static_cast<std::uint16_t>(to_y), true});
        }
    agreement.add(std::move(batch));
    agreement.add(Frame{t, "frames", to_frames});
  }
  return agreement;
}

TEST(EventAgreement, SaysNothingOfEventsOnTheEdgesOfTheFramesOrOfUnrelatedOnes) {
  const auto as_given = [](int x, int y) { return std::pair(x, y); };
  EXPECT_EQ(shown(picture(1), picture(1), as_given).better(), std::nullopt);
  EXPECT_EQ(shown(picture(1), picture(2), as_given).better(), std::nullopt);
}

TEST(EventAgreement, NamesHowEventsAreTurnedOrMirrored) {
  const auto told = [](const auto& flip) { return shown(picture(1), picture(1), flip).better(); };
  EXPECT_EQ(told([](int x, int y) { return std::pair(239 - x, 179 - y); }), "turned by 180 deg");
  EXPECT_EQ(told([](int x, int y) { return std::pair(239 - x, y); }), "mirrored left to right");
  EXPECT_EQ(told([](int x, int y) { return std::pair(x, 179 - y); }), "mirrored top to bottom");
}

/// As of a region of interest whose origin the driver leaves out.
TEST(EventAgreement, NamesHowFarEventsAreMoved) {
  const auto moved = [](int x, int y) { return std::pair(std::max(x - 30, 0), std::max(y - 15, 0)); };
  EXPECT_EQ(shown(picture(1), picture(1), moved).better(), "moved by about (+30, +15) px");
}

}  // namespace
}  // namespace edged
