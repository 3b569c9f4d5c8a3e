// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/keyframe_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace edged {
namespace {

const CameraModel kCamera(240, 180, 200, 200, 119.5, 89.5);

const std::string kName = "frames";

Timestamp at(double t_s) { return timestamp_from_seconds(t_s); }

/// All at the origin of the map.
MapQuery queried_views(double before_s, std::string_view camera = kName) {
  static const std::vector<SE3> kThere(3);
  return {camera, {.before = at(before_s)}, kThere};
}

/// A wall 2 m ahead, its points 20 px apart.
MapView view_of_wall(const std::string& camera, const SE3& T_B_C = SE3(), double depth_sigma = 0.01) {
  MapView created{camera, T_B_C, {}};
  for (int x = 20; x < 230; x += 20) {
    for (int y = 20; y < 170; y += 20) {
      MapPoint point;
      point.pixel = {x, y};
      point.point = kCamera.pixel_to_point(point.pixel);
      point.inverse_depth = 0.5;
      point.sigma = depth_sigma * 0.5;
      created.points.push_back(point);
    }
  }
  return created;
}

MapKeyframe keyframe(double t_s, double depth_sigma = 0.01) {
  return {at(t_s), at(t_s), {view_of_wall(kName, SE3(), depth_sigma)}};
}

TEST(KeyframeMap, KeepsOnlyWhatItGainsBy) {
  const KeyframeMap map({});
  MapKeyframe good = keyframe(5.0), vague = keyframe(5.0, 0.3);
  EXPECT_TRUE(map.needs_keyframe(0.2));
  EXPECT_TRUE(map.prune_points(good));
  EXPECT_EQ(good.views.front().points.size(), 60U) << "the best-placed";
  EXPECT_FALSE(map.needs_keyframe(0.8));
  EXPECT_TRUE(map.needs_keyframe(0.0));
  EXPECT_FALSE(map.prune_points(vague));
}

TEST(KeyframeMap, KeepsADistanceInTime) {
  KeyframeMap map({});
  map.add(keyframe(5.0));
  MapKeyframe soon = keyframe(5.1), later = keyframe(5.5);
  EXPECT_FALSE(map.prune_points(soon));
  EXPECT_TRUE(map.prune_points(later));
}

TEST(KeyframeMap, ExpectsPointsWhereTheyShouldBeAndHowTheyShouldLook) {
  KeyframeMap map({});
  map.add(keyframe(5.0));
  const SE3 T_M_C(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.4});
  const std::vector<Candidate> seen = map.visible(queried_views(10.0), T_M_C, kCamera, 40);
  ASSERT_GT(seen.size(), 20U);
  ASSERT_LE(seen.size(), 40U);
  std::set<std::pair<int, int>> cells;
  for (const Candidate& c : seen) {
    const Eigen::Vector2d expected = *kCamera.project(T_M_C.inverse() * c.observation.p_K);
    EXPECT_LT((c.pixel - expected).norm(), 1e-9);
    EXPECT_LT((c.A - 1.25 * Eigen::Matrix2d::Identity()).norm(), 1e-6) << "2 m then, 1.6 m now";
    EXPECT_NEAR(c.observation.depth_sigma_K.norm(), 0.01 * c.observation.p_K.norm(), 1e-12);
    EXPECT_TRUE(cells.emplace(static_cast<int>(c.pixel.x()) / 16, static_cast<int>(c.pixel.y()) / 16).second);
  }
}

TEST(KeyframeMap, ExpectsNothingFromAfarFromAsideOrOfTheNewest) {
  KeyframeMap map({});
  map.add(keyframe(5.0));
  const auto count = [&](const SE3& T_M_C, double t_s) {
    return map.visible(queried_views(t_s), T_M_C, kCamera, 40).size();
  };
  EXPECT_GT(count(SE3(), 10.0), 0U);
  EXPECT_EQ(count(SE3(), 4.5), 0U) << "the window has them";
  EXPECT_TRUE(map.visible(queried_views(10.0, "events"), SE3(), kCamera, 40).empty()) << "another camera's";
  EXPECT_EQ(count(SE3(Eigen::Quaterniond::Identity(), {0.0, 0.0, -3.5}), 10.0), 0U) << "too small";
  EXPECT_EQ(count(SE3(so3::exp({0.0, M_PI, 0.0}), Eigen::Vector3d::Zero()), 10.0), 0U) << "behind";
  EXPECT_EQ(count(SE3(so3::exp({0.0, -0.9, 0.0}), {2.2, 0.0, 0.6}), 10.0), 0U) << "from aside";
}

TEST(KeyframeMap, ExpectsInEachCameraTheViewsOfThatCamera) {
  const SE3 T_B_rear(so3::exp({0.0, M_PI, 0.0}), {0.0, 0.0, -0.2});
  KeyframeMap map({});
  map.add({at(5.0), at(5.0), {view_of_wall(kName), view_of_wall("rear", T_B_rear)}});
  ASSERT_FALSE(map.visible(queried_views(10.0), SE3(), kCamera, 40).empty());
  EXPECT_TRUE(map.visible(queried_views(10.0, "rear"), SE3(), kCamera, 40).empty()) << "it points away from that wall";
  const std::vector<Candidate> behind = map.visible(queried_views(10.0, "rear"), T_B_rear, kCamera, 40);
  ASSERT_FALSE(behind.empty());
  for (const Candidate& c : behind) {
    EXPECT_NEAR(c.observation.p_K.z(), -2.2, 1e-9) << "in the body";
    EXPECT_LT((c.pixel - *kCamera.project(T_B_rear.inverse() * c.observation.p_K)).norm(), 1e-9);
  }
  const MappedKeyframe seen = mapped(map.keyframes().front(), SE3());
  EXPECT_EQ(seen.camera, "frames rear");
  EXPECT_EQ(seen.points.size(), 2 * view_of_wall(kName).points.size());
}

TEST(KeyframeMap, KeepsOfSeveralViewsThoseWithEnoughPoints) {
  const KeyframeMap map({});
  MapKeyframe created{at(5.0), at(5.0), {view_of_wall("left", SE3(), 0.3), view_of_wall("right")}};
  ASSERT_TRUE(map.prune_points(created));
  ASSERT_EQ(created.views.size(), 1U);
  EXPECT_EQ(created.views.front().camera, "right");
}

TEST(KeyframeMap, GivesUpPointsThatAreNeverFound) {
  KeyframeMap map({});
  map.add(keyframe(5.0));
  for (int i = 0; i < 12; ++i) {
    for (Candidate& c : map.visible(queried_views(10.0), SE3(), kCamera, 1000)) {
      c.matched = c.pixel.x() > 120.0;
      map.record_search(c, at(10.0 + i));
    }
  }
  for (const Candidate& c : map.visible(queried_views(30.0), SE3(), kCamera, 1000)) EXPECT_GT(c.pixel.x(), 120.0);
  EXPECT_EQ(map.keyframes().front().matched_at, at(21.0));
}

TEST(KeyframeMap, LetsGoWhatWasNotFoundForLongest) {
  KeyframeMapConfig config;
  config.max_keyframes = 2;
  KeyframeMap map(config);
  for (const double t_s : {5.0, 6.0}) map.add(keyframe(t_s));
  EXPECT_FALSE(map.redundant_keyframe());
  Candidate of_first = map.visible(queried_views(7.5), SE3(), kCamera, 1).front();  // only the first is old enough
  of_first.matched = true;
  map.record_search(of_first, at(7.5));
  map.add(keyframe(8.0));
  ASSERT_TRUE(map.redundant_keyframe());
  EXPECT_EQ(*map.redundant_keyframe(), 1U);
  map.remove(1);
  EXPECT_EQ(map.keyframes().back().t, at(8.0));
  EXPECT_FALSE(map.redundant_keyframe());
}

/// More keyframes than are compared with an image one by one.
TEST(KeyframeMap, RecognizesAPlaceAmongManyAfterOthersAreRemoved) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  KeyframeMap map({});
  const Eigen::Quaterniond R_M_C(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()));
  std::vector<SE3> T_M_K;
  for (int k = 0; k < 250; ++k) {
    MapView view{kName, SE3(), {}};
    for (int i = 0; i < 40; ++i) {
      MapPoint& point = view.points.emplace_back();
      point.point = {place(random), place(random)};
      point.inverse_depth = 0.5;
      point.descriptor = Descriptor{random(), random(), random(), random()};
    }
    map.add({at(k), at(k), {std::move(view)}});
    T_M_K.emplace_back(R_M_C, Eigen::Vector3d(k, 0.0, 0.0));
  }
  std::vector<std::optional<Descriptor>> descriptors;
  std::vector<Eigen::Vector2d> points;
  for (const MapPoint& point : map.keyframes()[180].views.front().points) {
    descriptors.push_back(point.descriptor);
    (*descriptors.back())[0] ^= 0x00ff0000ff000000;
    points.push_back(point.point);
  }
  for (const std::size_t gone : {200U, 20U}) {
    map.remove(gone);
    T_M_K.erase(T_M_K.begin() + gone);
  }
  const std::optional<SE3> T_M_C = map.recognize({kName, {}, T_M_K}, descriptors, points, R_M_C, 200.0).T_M_C;
  ASSERT_TRUE(T_M_C);
  EXPECT_LT((T_M_C->translation() - Eigen::Vector3d(180.0, 0.0, 0.0)).norm(), 0.01);
  EXPECT_FALSE(map.recognize({kName, {.before = at(170.0)}, T_M_K}, descriptors, points, R_M_C, 200.0).T_M_C);
  EXPECT_FALSE(map.recognize({"events", {}, T_M_K}, descriptors, points, R_M_C, 200.0).T_M_C);
}

}  // namespace
}  // namespace edged
