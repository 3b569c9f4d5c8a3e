// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/target_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace edged {
namespace {

/// Bars 12 px wide that move to and fro by 40 px; each pixel takes 8 steps over an edge of 2 px.
std::vector<Event> moving_bars(int width, int height, double length_s) {
  constexpr int kSteps = 8;
  const auto place = [](double t) { return 40.0 * std::sin(4.0 * t); };
  const auto level = [&](int x, double t) {  // in steps, black to white
    const double u = std::fmod(x - place(t) + 1200.0, 24.0);
    const double edge = u < 12.0 ? std::min(u, 12.0 - u) : -std::min(u - 12.0, 24.0 - u);
    return static_cast<int>(std::floor(kSteps * std::clamp(0.5 + 0.5 * edge, 0.0, 1.0)));
  };
  std::vector<Event> out;
  std::vector<int> now(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) now[static_cast<std::size_t>(x)] = level(x, 0.0);
  for (double t = 0.0; t < length_s; t += 2e-4)
    for (int x = 0; x < width; ++x) {
      const int wanted = level(x, t);
      int& at = now[static_cast<std::size_t>(x)];
      for (; at != wanted; at += wanted > at ? 1 : -1)
        for (int y = 0; y < height; ++y)
          out.push_back(
              {timestamp_from_seconds(t), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), wanted > at});
    }
  return out;
}

TEST(TargetPictures, HaveTheirEdgesWhereTheyAreAtThatInstantWhicheverWayTheyMove) {
  constexpr int kWidth = 96, kHeight = 8;
  const std::vector<Event> events = moving_bars(kWidth, kHeight, 3.0);
  std::vector<double> offs;
  TargetPictures pictures(kWidth, kHeight, [&](Timestamp t, const cv::Mat& picture) {
    // A bar rises from black to white at u = 0.
    const double place = 40.0 * std::sin(4.0 * to_seconds(t));
    for (int x = 20; x < kWidth - 20; ++x) {
      const int a = picture.at<std::uint8_t>(4, x), b = picture.at<std::uint8_t>(4, x + 1);
      const bool rises = a < 128 && b >= 128, falls = a >= 128 && b < 128;
      if (!rises && !falls) continue;
      const double at = x + (128.0 - a) / (b - a);
      const double phase = std::fmod(at - place + 1200.0 + (rises ? 6.0 : -6.0), 24.0) - 6.0;
      // Black is wider on both sides alike.
      offs.push_back(rises ? phase : -phase);
    }
  });
  for (const double t : {1.0, 1.3, 1.45, 1.7, 2.0, 2.2}) pictures.add_instant(timestamp_from_seconds(t));
  pictures.add(events);
  pictures.finish();
  ASSERT_GE(offs.size(), 20u);
  double low = 1e9, high = -1e9;
  for (const double off : offs) low = std::min(low, off), high = std::max(high, off);
  EXPECT_LT(high - low, 0.7) << low << " " << high;
  EXPECT_LT(std::abs(0.5 * (low + high)), 1.0);
}

TEST(TargetPictures, AreNotMadeWhileNothingMoves) {
  std::size_t count = 0;
  TargetPictures pictures(32, 32, [&](Timestamp, const cv::Mat&) { ++count; });
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) events.push_back({timestamp_from_seconds(0.1 * i), 5, 5, true});
  pictures.add_instant(timestamp_from_seconds(1.0));
  pictures.add(events);
  pictures.finish();
  EXPECT_EQ(count, 0u);
}

}  // namespace
}  // namespace edged
