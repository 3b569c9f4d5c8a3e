// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Voxel grids against values worked out by hand.
#include "edged/events/voxel_grid.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

Event event_at(std::int64_t us, int x, int y, bool positive) {
  return {Timestamp(std::chrono::microseconds(us)), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
          positive};
}

float at(const cv::Mat& grid, int bin, int y, int x) { return grid.at<float>(std::array{0, bin, y, x}.data()); }

cv::Mat filled(int bins, int height, int width) {
  cv::Mat grid(std::vector<int>{1, bins, height, width}, CV_32FC1);
  for (int b = 0; b < bins; ++b)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) grid.at<float>(std::array{0, b, y, x}.data()) = 100.0F * b + 10.0F * y + x;
  return grid;
}

TEST(VoxelGrid, SharesAnEventBetweenTheTwoBinsAroundItsTime) {
  // 0 .. 1000 us are bins 0 .. 4: 250 us a bin.
  const std::vector<Event> events{event_at(0, 1, 2, true), event_at(300, 3, 0, true), event_at(875, 0, 3, false),
                                  event_at(1000, 2, 1, false)};
  const cv::Mat grid = voxel_grid(events, cv::Rect(0, 0, 4, 4));
  ASSERT_EQ(grid.dims, 4);
  EXPECT_EQ(grid.size[1], 5);
  EXPECT_FLOAT_EQ(at(grid, 0, 2, 1), 1.0F);
  EXPECT_FLOAT_EQ(at(grid, 1, 0, 3), 0.8F);
  EXPECT_FLOAT_EQ(at(grid, 2, 0, 3), 0.2F);
  EXPECT_FLOAT_EQ(at(grid, 3, 3, 0), -0.5F);
  EXPECT_FLOAT_EQ(at(grid, 4, 3, 0), -0.5F);
  EXPECT_FLOAT_EQ(at(grid, 4, 1, 2), -1.0F);
  EXPECT_EQ(cv::countNonZero(grid.reshape(1, 1)), 6);
}

TEST(VoxelGrid, CropsTheEventsButTakesItsTimesFromAllOfThem) {
  const std::vector<Event> events{event_at(0, 0, 0, true), event_at(500, 11, 22, true), event_at(1000, 99, 0, true)};
  const cv::Mat grid = voxel_grid(events, cv::Rect(10, 20, 8, 6));
  EXPECT_EQ(grid.size[2], 6);
  EXPECT_EQ(grid.size[3], 8);
  EXPECT_FLOAT_EQ(at(grid, 2, 2, 1), 1.0F);
  EXPECT_EQ(cv::countNonZero(grid.reshape(1, 1)), 1);
}

TEST(VoxelGrid, TakesEventsOfOneInstantIntoTheFirstBin) {
  const std::vector<Event> events{event_at(7, 1, 1, true), event_at(7, 1, 1, true)};
  EXPECT_FLOAT_EQ(at(voxel_grid(events, cv::Rect(0, 0, 2, 2)), 0, 1, 1), 2.0F);
}

TEST(VoxelGrid, IsZeroWithoutEvents) {
  cv::Mat grid = voxel_grid({}, cv::Rect(0, 0, 3, 2));
  normalise_voxels(grid);
  EXPECT_EQ(cv::countNonZero(grid.reshape(1, 1)), 0);
}

TEST(VoxelGrid, OfUnixTimeKeepsItsMicroseconds) {
  constexpr std::int64_t kUnix = 1'700'000'000'000'000;
  const std::vector<Event> events{event_at(kUnix, 0, 0, true), event_at(kUnix + 5, 1, 0, true),
                                  event_at(kUnix + 8, 0, 0, true)};
  EXPECT_FLOAT_EQ(at(voxel_grid(events, cv::Rect(0, 0, 2, 1)), 2, 0, 1), 0.5F);
}

TEST(VoxelNormalisation, UsesMeanAndDeviationOfTheVoxelsThatAreNotZero) {
  cv::Mat grid = voxel_grid({}, cv::Rect(0, 0, 3, 1));
  grid.at<float>(std::array{0, 0, 0, 0}.data()) = 1.0F;
  grid.at<float>(std::array{0, 3, 0, 2}.data()) = 3.0F;
  grid.at<float>(std::array{0, 4, 0, 1}.data()) = -1.0F;
  normalise_voxels(grid);  // mean 1, deviation sqrt(8 / 3)
  EXPECT_NEAR(at(grid, 0, 0, 0), 0.0F, 1e-6);
  EXPECT_NEAR(at(grid, 3, 0, 2), std::sqrt(1.5), 1e-6);
  EXPECT_NEAR(at(grid, 4, 0, 1), -std::sqrt(1.5), 1e-6);
  EXPECT_EQ(at(grid, 1, 0, 0), 0.0F);
}

TEST(VoxelNormalisation, DoneTwiceIsDoneOnce) {
  cv::Mat grid = filled(5, 9, 11);
  normalise_voxels(grid);
  cv::Mat again = grid.clone();
  normalise_voxels(again);
  EXPECT_LT(cv::norm(grid.reshape(1, 1), again.reshape(1, 1), cv::NORM_INF), 1e-5);
}

TEST(VoxelNormalisation, LeavesVoxelsOfOneValueAlone) {
  cv::Mat grid = voxel_grid(std::vector{event_at(0, 0, 0, true), event_at(9, 1, 0, true)}, cv::Rect(0, 0, 2, 1));
  normalise_voxels(grid);
  EXPECT_FLOAT_EQ(at(grid, 0, 0, 0), 1.0F);
  EXPECT_FLOAT_EQ(at(grid, 4, 0, 1), 1.0F);
}

TEST(VoxelPadding, HasTheSizesOfTheOriginal) {
  for (const auto& [n, before, after] :
       {std::array{346, 3, 3}, std::array{260, 2, 2}, std::array{180, 2, 2}, std::array{240, 0, 0},
        std::array{345, 4, 3}, std::array{1280, 0, 0}, std::array{9, 4, 3}}) {
    const Padding padding = padding_to_multiple(n, 8);
    EXPECT_EQ(padding.before, before) << n;
    EXPECT_EQ(padding.after, after) << n;
    const int padded = n + before + after;
    EXPECT_EQ(padded / 2 - n / 2, before) << "where the original cuts its output back, " << n;
  }
}

TEST(VoxelPadding, ReflectsAtTheBorderPixel) {
  const cv::Mat padded = pad_voxels(filled(2, 8, 11), 8);  // 3 + 2 columns
  ASSERT_EQ(padded.size[2], 8);
  ASSERT_EQ(padded.size[3], 16);
  for (int bin = 0; bin < 2; ++bin) {
    const float base = 100.0F * static_cast<float>(bin) + 50.0F;
    EXPECT_EQ(at(padded, bin, 5, 3), base);
    EXPECT_EQ(at(padded, bin, 5, 2), base + 1);
    EXPECT_EQ(at(padded, bin, 5, 0), base + 3);
    EXPECT_EQ(at(padded, bin, 5, 13), base + 10);
    EXPECT_EQ(at(padded, bin, 5, 14), base + 9);
    EXPECT_EQ(at(padded, bin, 5, 15), base + 8);
  }
}

TEST(VoxelPadding, RefusesAGridSmallerThanTheMultiple) { EXPECT_THROW(pad_voxels(filled(5, 8, 7), 8), CheckError); }

TEST(VoxelShrinking, TakesTheMeanOfEachBlock) {
  const cv::Mat small = shrink_voxels(filled(2, 4, 6), 2);
  ASSERT_EQ(small.size[2], 2);
  ASSERT_EQ(small.size[3], 3);
  EXPECT_FLOAT_EQ(at(small, 0, 0, 0), 5.5F);    // 0, 1, 10, 11
  EXPECT_FLOAT_EQ(at(small, 1, 1, 2), 129.5F);  // 124, 125, 134, 135
  EXPECT_THROW(shrink_voxels(filled(2, 4, 5), 2), CheckError);
}

TEST(Region, LiesInTheMiddleAndGrowsWhereThereIsRoom) {
  EXPECT_EQ(central_region(cv::Size(240, 180), 0.5), cv::Rect(60, 45, 120, 90));
  EXPECT_EQ(central_region(cv::Size(240, 180), 1.0), cv::Rect(0, 0, 240, 180));
  EXPECT_EQ(grown_region(cv::Rect(60, 45, 120, 90), 20, cv::Size(240, 180)), cv::Rect(40, 25, 160, 130));
  EXPECT_EQ(grown_region(cv::Rect(60, 45, 120, 90), 50, cv::Size(240, 180)), cv::Rect(10, 0, 220, 180));
}

}  // namespace
}  // namespace edged
