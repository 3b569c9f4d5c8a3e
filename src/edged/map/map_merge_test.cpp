// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/map_merge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "edged/map/map_filter.hpp"

namespace edged {
namespace {

/// A wall of points with distinct descriptors, observed from neighbouring places; everything in a frame A.
struct Wall {
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;

  explicit Wall(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> across(-2.0, 2.0), deep(2.5, 4.0);
    for (int i = 0; i < 60; ++i) {
      points.emplace_back(across(random), deep(random), 0.5 * across(random));
      descriptors.push_back({random(), random(), random(), random()});
    }
  }

  /// From the body at T_A_K, as a run would save it whose frame B lies at T_A_B.
  SavedMap map_from(const std::vector<SE3>& T_A_K, const SE3& T_A_B) const {
    const SE3 T_K_C(Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX())), {0.1, 0.0, 0.05});
    SavedMap map;
    map.cameras = {{"frames", 240, 180, 200.0}};
    for (std::size_t k = 0; k < T_A_K.size(); ++k) {
      const Timestamp t = Timestamp() + std::chrono::seconds(k);
      MapView view{"frames", T_K_C, {}};
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d p_C = (T_A_K[k] * T_K_C).inverse() * points[i];
        if (p_C.z() < 0.5 || p_C.hnormalized().norm() > 0.8) continue;
        view.points.push_back(
            {0, p_C.hnormalized(), 1.0 / p_C.z(), 0.01 / p_C.z(), {}, descriptors[i], Eigen::Vector2d::Zero(), 0, 0});
      }
      map.keyframes.push_back({t, t, {view}});
      map.T_M_K.push_back(T_A_B.inverse() * T_A_K[k]);
    }
    map.covariance = 1e-6 * Eigen::MatrixXd::Identity(6 * std::ssize(T_A_K), 6 * std::ssize(T_A_K));
    return saved_map_from_bytes(to_bytes(map));
  }
};

std::vector<SE3> places(double x, int n) {
  std::vector<SE3> T;
  for (int k = 0; k < n; ++k) T.emplace_back(so3::exp({0.0, 0.02 * k, 0.05 * k}), Eigen::Vector3d(x + 0.2 * k, 0, 0.1));
  return T;
}

const SE3 kT_A_B(so3::exp({0.0, 0.0, 1.2}), {3.0, -1.0, 0.4});  // gravity is known in both

TEST(MapMerge, FindsTheOtherMapByItsLooks) {
  const Wall wall(1);
  const auto [T_A_B, refusal] =
      find_map_in(wall.map_from(places(-0.5, 5), SE3()), wall.map_from(places(-0.4, 4), kT_A_B));
  ASSERT_TRUE(T_A_B) << refusal;
  EXPECT_LT((T_A_B->inverse() * kT_A_B).log().norm(), 1e-2);
}

TEST(MapMerge, TakesNoOtherPlaceForIt) {
  const SavedMap map = Wall(1).map_from(places(-0.5, 5), SE3());
  const auto refusal = [&](const SavedMap& one, const SavedMap& other) {
    const MapAlignment found = find_map_in(one, other);
    EXPECT_FALSE(found.T_A_B);
    return found.refusal;
  };
  EXPECT_THAT(refusal(map, Wall(2).map_from(places(-0.4, 4), kT_A_B)),
              testing::MatchesRegex("none of its 4 keyframes is recognized there: in the nearest [0-9]+ features agree "
                                    "on a place, of [0-9]+ that are similar; 8 and 30 % are needed"));
  EXPECT_EQ(refusal(map, Wall(1).map_from(places(-0.4, 2), kT_A_B)),
            "2 of its 2 keyframes are recognized there, 2 of them at one place of the two maps to each other; 3 and 50 "
            "% are needed");
  EXPECT_EQ(refusal(map, SavedMap()), "no camera has keyframes in both");
  EXPECT_EQ(refusal(SavedMap(), map), "no camera has keyframes in both");
}

TEST(MapMerge, BothLieInOneFrame) {
  const Wall wall(1);
  const std::vector<SE3> T_A_K = places(-0.4, 4);
  const SavedMap map = wall.map_from(places(-0.5, 5), SE3()), other = wall.map_from(T_A_K, kT_A_B);
  const SavedMap both = merged(map, other, kT_A_B);
  ASSERT_EQ(both.keyframes.size(), 9U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((both.T_M_K[k].inverse() * T_A_K[k]).log().norm(), 1e-9);
  // The covariance of the others is unchanged; these two are more certain relative to each other than to the others.
  EXPECT_EQ(both.covariance.bottomRightCorner(30, 30), map.covariance);
  const Eigen::MatrixXd P = both.covariance.topLeftCorner(12, 12);
  EXPECT_GT(P(0, 0), 0.04 * 0.04);
  EXPECT_LT(P(0, 0) + P(6, 6) - 2.0 * P(0, 6), 0.02 * 0.02);
  EXPECT_NO_THROW(saved_map_from_bytes(to_bytes(both)));  // in order of time, with valid values
}

/// Checks the other map's first two keyframes, of which one is inactive: their uncertainty is as if it were active.
TEST(MapMerge, KeepsTheUncertaintyOfInactiveKeyframes) {
  const Wall wall(1);
  const SavedMap map = wall.map_from(places(-0.5, 5), SE3());
  SavedMap other = wall.map_from(places(-0.4, 4), kT_A_B);
  const Eigen::MatrixXd root = 0.01 * Eigen::MatrixXd::Random(24, 24);
  other.covariance = root * root.transpose();
  const SavedMap all_active = merged(map, other, kT_A_B);
  MapFilter filter(MapFilterConfig{}, false, 3);
  filter.load(other.T_M_K, other.covariance);
  filter.predict(SE3(), SE3(), Timestamp(), {});
  other.covariance = filter.keyframe_covariance();
  other.inactive = filter.inactive();
  ASSERT_EQ(other.inactive.size(), 1U);
  const SavedMap one_inactive = saved_map_from_bytes(to_bytes(merged(map, other, kT_A_B)));
  ASSERT_EQ(one_inactive.inactive.size(), 1U);
  filter.load(one_inactive.T_M_K, one_inactive.covariance, one_inactive.inactive);
  filter.activate(std::array{0U});
  EXPECT_LT((filter.keyframe_covariance() - all_active.covariance).norm(), 1e-6 * all_active.covariance.norm());
}

}  // namespace
}  // namespace edged
