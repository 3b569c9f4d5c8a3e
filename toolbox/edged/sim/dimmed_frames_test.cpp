// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/dimmed_frames.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <set>

#include "edged/core/measurements/recording_piece.hpp"
#include "edged/sim/test_recording.hpp"

namespace edged {
namespace {

Recorded dimmed(double factor, double from_s = 0.0) {
  std::unique_ptr<Dataset> dataset = std::make_unique<Simulator>(small("room", 0.8));
  if (from_s > 0.0) dataset = std::make_unique<RecordingPiece>(std::move(dataset), PieceBounds{from_s, {}});
  DimmedFrames frames(std::move(dataset), factor);
  return record(frames);
}

TEST(DimmedFrames, HaveTheMeanAndTheNoiseOfLittleLight) {
  const Recorded bright = record(small("room", 0.8)), dark = dimmed(0.06);
  ASSERT_EQ(dark.frames.size(), bright.frames.size());
  ASSERT_GT(dark.frames.size(), 10U);
  // At rest, the difference of two frames is noise: of the photons, 1.2 levels of read noise, and 1/12 of rounding.
  const cv::Mat &first = dark.frames[1].image, &second = dark.frames[3].image;
  const double level = 0.06 * cv::mean(bright.frames[1].image)[0];
  EXPECT_NEAR(cv::mean(first)[0], level, 0.1);
  cv::Mat difference;
  cv::subtract(first, second, difference, cv::noArray(), CV_32F);
  cv::Scalar mean, sigma;
  cv::meanStdDev(difference, mean, sigma);
  EXPECT_NEAR(sigma[0] / std::sqrt(2.0), std::sqrt(1.2 * 1.2 + level * 255.0 / 10000.0 + 1.0 / 12.0), 0.05);
  EXPECT_LT(std::set<int>(first.begin<std::uint8_t>(), first.end<std::uint8_t>()).size(), 24U);
}

TEST(DimmedFrames, AreTheSameWhereverReadingBegan) {
  const Recorded whole = dimmed(0.06), late = dimmed(0.06, 0.5);
  ASSERT_GT(late.frames.size(), 4U);
  EXPECT_EQ(cv::norm(whole.frames.back().image, late.frames.back().image, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(whole.frames[1].image, whole.frames[3].image, cv::NORM_INF), 0.0);
}

TEST(DimmedFrames, LeaveEventsAndImuAsTheyWere) {
  Recorded bright = record(small("room", 0.8)), dark = dimmed(0.06);
  bright.frames.clear(), dark.frames.clear();
  EXPECT_TRUE(same(bright, dark));
}

}  // namespace
}  // namespace edged
