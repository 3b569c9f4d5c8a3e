// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Depth of a plane, what has no depth, culling and fusion.
#include "edged/dense/depth_map.hpp"

#include <gtest/gtest.h>

#include "edged/dense/test_plane.hpp"

namespace edged {
namespace {

constexpr InverseDepthRange kPlaneRange{0.2, 1.5};

DepthMap map_of(const TestPlane& plane, double step_m) {
  const DenseView reference = plane.view({});
  std::vector<DenseView> views;
  for (int i = 1; i <= 4; ++i)
    for (const int side : {-1, 1}) views.push_back(plane.view(shifted(step_m * i * side)));
  std::vector<const DenseView*> pointers;
  for (const DenseView& view : views) pointers.push_back(&view);
  return estimate_depth(reference, pointers, kPlaneRange, {}, {});
}

TEST(DepthMapOfAPlane, HasItsDepthAndSigmas) {
  const TestPlane plane;
  const DepthMap map = map_of(plane, 0.08);
  ASSERT_GT(map.edges, 300U);
  EXPECT_GT(map.points.size(), 6 * map.edges / 10);
  EXPECT_LT(plane.median_error({map}), 0.003);
  std::size_t within = 0;
  for (const DensePoint& point : map.points)
    within += std::abs(point.inverse_depth - 1.0 / plane.depth({}, {point.x, point.y})) < 3.0 * point.sigma;
  EXPECT_GT(within, 97 * map.points.size() / 100);
}

TEST(DepthMapOfAPlane, IsEmptyWithoutParallaxOrTexture) {
  EXPECT_TRUE(map_of(TestPlane(), 0.0).points.empty());
  EXPECT_EQ(map_of(TestPlane([](double, double) { return 90.0; }), 0.08).edges, 0U);
}

TEST(DepthMapOfAPlane, LeavesOutWhatTheMotionDoesNotTell) {
  const auto along = [](double, double y) { return 128.0 + 60.0 * std::sin(20.0 * y); };
  const auto repeated = [](double x, double) { return 128.0 + 60.0 * std::sin(60.0 * x); };
  const DenseView reference = TestPlane(along).view({});
  std::vector<DenseView> views;
  for (const double x_m : {0.1, 0.15, 0.2, 0.25})
    views.push_back(TestPlane(along).view({Eigen::Quaterniond::Identity(), {x_m, 0.0, 0.0}}));
  std::vector<const DenseView*> pointers;
  for (const DenseView& view : views) pointers.push_back(&view);
  EXPECT_LT(estimate_depth(reference, pointers, kPlaneRange, {}, {}).points.size(), 10U);
  const DepthMap ambiguous = map_of(TestPlane(repeated), 0.2);
  EXPECT_LT(ambiguous.points.size(), ambiguous.edges / 20);
}

DepthMap small_map(std::vector<DensePoint> points) {
  return {Timestamp{}, "frames", TestPlane::pinhole(), {}, points.size(), std::move(points)};
}

TEST(Cull, RemovesPointsAloneAndThoseThatNeighboursContradict) {
  DepthMap map = small_map({{20, 20, 0.5F, 0.01F, 0, 5},
                            {21, 20, 0.51F, 0.01F, 0, 5},
                            {22, 20, 0.5F, 0.01F, 0, 5},
                            {21, 21, 0.9F, 0.01F, 0, 5},
                            {90, 90, 0.5F, 0.01F, 0, 5}});
  cull(map, {});
  ASSERT_EQ(map.points.size(), 3U);
  for (const DensePoint& point : map.points) EXPECT_EQ(point.y, 20);
}

TEST(Fuse, MovesWhatTheNewerImageShowsWithTheSameDepth) {
  DepthMap older = small_map({{80, 60, 0.5F, 0.01F, 0, 5}, {40, 60, 0.5F, 0.01F, 0, 250}, {10, 60, 0.5F, 0.01F, 0, 5}});
  DepthMap newer = small_map({{80, 60, 0.52F, 0.01F, 0, 5}, {40, 60, 0.9F, 0.01F, 0, 5}});
  fuse(older, newer, {});
  ASSERT_EQ(older.points.size(), 2U) << "another depth, and a pixel without one";
  EXPECT_NEAR(newer.points[0].inverse_depth, 0.51F, 1e-5F);
  EXPECT_NEAR(newer.points[0].sigma, 0.01F / std::sqrt(2.0F), 1e-6F);
  EXPECT_EQ(newer.points[0].views, 10);
  EXPECT_EQ(newer.points[1].views, 5);
}

TEST(Fuse, ComparesDepthsInTheNewerCamera) {
  DepthMap older = small_map({{80, 60, 0.5F, 0.01F, 0, 5}}), newer = small_map({{80, 60, 1.0F, 0.01F, 0, 5}});
  newer.T_O_C = {Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}};
  fuse(older, newer, {});
  EXPECT_TRUE(older.points.empty());
  EXPECT_NEAR(newer.points[0].inverse_depth, 1.0F, 1e-3F);
}

}  // namespace
}  // namespace edged
