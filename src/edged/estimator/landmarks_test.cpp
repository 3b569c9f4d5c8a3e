// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/landmarks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Keyframes at the true poses, 0.2 s apart, with what the cameras see.
Window window_at_truth(TestWorld& world, int states = 6) {
  Window window(world.rig(), 1.0);
  for (int i = 0; i < states; ++i) {
    const double t = 1.0 + 0.2 * i;
    WindowState state;
    state.t = timestamp_from_seconds(t);
    state.pose = to_block(world.T_W_B(t));
    state.keyframe = true;
    const StateId id = window.add_state(std::move(state));
    for (std::size_t camera = 0; camera < world.rig().cameras.size(); ++camera) {
      window.add_observations(id, {world.observe(t, camera)});
    }
  }
  return window;
}

int count_landmarks(const Window& window) {
  return static_cast<int>(std::count_if(window.features.begin(), window.features.end(),
                                        [](const auto& entry) { return entry.second.anchor.has_value(); }));
}

/// A landmark that every state sees.
FeatureId seen_by_all(const Window& window) {
  for (const auto& [id, feature] : window.features) {
    if (feature.anchor && feature.seen.size() == window.states.size()) return id;
  }
  return 0;
}

constexpr LandmarkConfig kGenerous = [] {
  LandmarkConfig config;
  config.max_per_camera = 500;
  config.max_misfit = 1000.0;  // observations are judged one by one
  return config;
}();

TEST(TriangulateFeatures, PutsLandmarksWhereThePointsAreInEveryCamera) {
  TestWorld world({.cameras = 2, .pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  std::size_t landmarks[2] = {0, 0};
  for (const auto& [id, feature] : window.features) {
    if (!feature.anchor) continue;
    ++landmarks[feature.camera];
    EXPECT_LT((window.position(feature) - world.point_W(id)).norm(), 1e-4) << id;
  }
  EXPECT_GT(landmarks[0], 40U);
  EXPECT_GT(landmarks[1], 40U);
}

TEST(TriangulateFeatures, WaitsForParallax) {
  TestWorld world({.speed = 0.0, .pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  // The camera sits 4 cm off the body's axis, so that turning alone shifts it, by less than the limit.
  EXPECT_EQ(count_landmarks(window), 0);
}

TEST(TriangulateFeatures, KeepsTheBudgetOfEachCameraAndPrefersTheLongestTracks) {
  TestWorld world({.cameras = 2, .pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, {.max_per_camera = 15});
  std::size_t landmarks[2] = {0, 0}, shortest_landmark[2] = {99, 99}, longest_track[2] = {0, 0};
  for (const auto& [id, feature] : window.features) {
    const std::size_t observations = feature.seen.size(), c = feature.camera;
    if (feature.anchor) {
      ++landmarks[c];
      shortest_landmark[c] = std::min(shortest_landmark[c], observations);
    } else if (window.alive(feature)) {
      longest_track[c] = std::max(longest_track[c], observations);
    }
  }
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(landmarks[c], 15U);
    EXPECT_GE(shortest_landmark[c], longest_track[c]);
  }
  triangulate_features(window, {.max_per_camera = 15});
  EXPECT_EQ(count_landmarks(window), 30);
}

TEST(TriangulateFeatures, RefusesDepthsOutOfBoundsAndTracksThatContradictThemselves) {
  TestWorld world({.pixel_noise = 0.0});
  Window near = window_at_truth(world);
  triangulate_features(near, {.min_depth_m = 5.0});
  EXPECT_EQ(count_landmarks(near), 0);
  Window far = window_at_truth(world);
  triangulate_features(far, {.max_depth_m = 1.0});
  EXPECT_EQ(count_landmarks(far), 0);

  Window wrong = window_at_truth(world);
  triangulate_features(wrong, kGenerous);
  const FeatureId id = seen_by_all(wrong);
  wrong.features.at(id).anchor.reset();
  std::next(wrong.features.at(id).seen.begin(), 3)->second.point.y() += 0.1;  // 20 px
  triangulate_features(wrong, kGenerous);
  EXPECT_FALSE(wrong.features.at(id).anchor.has_value());
}

TEST(TriangulateFeatures, AnchorsInTheOldestKeyframe) {
  TestWorld world({.pixel_noise = 0.0});
  Window window = window_at_truth(world);
  window.states.begin()->second.keyframe = false;
  triangulate_features(window, kGenerous);
  const FeatureId id = seen_by_all(window);
  ASSERT_NE(id, 0U);
  EXPECT_EQ(*window.features.at(id).anchor, std::next(window.states.begin())->first);
}

TEST(RemoveOutliers, KeepsWhatFits) {
  TestWorld world({});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  const int landmarks = count_landmarks(window);
  EXPECT_THAT(remove_outliers(window, kGenerous), IsEmpty());
  EXPECT_EQ(count_landmarks(window), landmarks);
}

TEST(RemoveOutliers, ReportsATrackWhoseNewestObservationIsWrongAndKeepsTheLandmark) {
  TestWorld world({.pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  const FeatureId id = seen_by_all(window);
  window.features.at(id).seen.rbegin()->second.point.x() += 0.05;  // 10 px
  EXPECT_THAT(remove_outliers(window, kGenerous), ElementsAre(id));
  EXPECT_EQ(window.features.at(id).seen.size(), window.states.size() - 1);
  EXPECT_TRUE(window.features.at(id).anchor.has_value());
}

TEST(RemoveOutliers, TakesOutAnOldWrongObservationWithoutEndingTheTrack) {
  TestWorld world({.pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  const FeatureId id = seen_by_all(window);
  std::next(window.features.at(id).seen.begin(), 2)->second.point.x() += 0.05;
  EXPECT_THAT(remove_outliers(window, kGenerous), IsEmpty());
  EXPECT_EQ(window.features.at(id).seen.size(), window.states.size() - 1);
}

TEST(RemoveOutliers, DropsALandmarkThatFitsWorseThanTheRestInNoObservationAlone) {
  TestWorld world({});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  const int landmarks = count_landmarks(window);
  const FeatureId id = seen_by_all(window);
  // It walks: to and fro by less than any one observation is taken out for.
  double step = 1.5;
  for (auto& [state, observation] : window.features.at(id).seen) {
    observation.point.y() += step * observation.sigma;
    step = -step;
  }
  LandmarkConfig strict = kGenerous;
  strict.max_residual_sigma = 20.0;
  EXPECT_THAT(remove_outliers(window, strict), IsEmpty());
  strict.max_misfit = 2.5;
  EXPECT_THAT(remove_outliers(window, strict), testing::Contains(id));
  EXPECT_GE(count_landmarks(window), landmarks - 3);
}

TEST(RemoveOutliers, DropsALandmarkOutOfBoundsAndReportsItWhileItIsTracked) {
  TestWorld world({.pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  const FeatureId tracked = seen_by_all(window);
  window.features.at(tracked).inverse_depth = -0.1;
  // The newest image no longer shows this one.
  const FeatureId ended = std::find_if(window.features.begin(), window.features.end(), [&](const auto& entry) {
                            return entry.second.anchor && entry.first != tracked;
                          })->first;
  window.features.at(ended).inverse_depth = 1e-4;
  window.features.at(ended).last_seen = window.states.begin()->first;
  const std::vector<FeatureId> wrong = remove_outliers(window, kGenerous);
  EXPECT_THAT(wrong, ElementsAre(tracked));
  EXPECT_FALSE(window.features.contains(tracked));
  EXPECT_FALSE(window.features.contains(ended));
}

/// Moves what the newest state sees of the first `count` landmarks by 20 px.
int move_newest_observations(Window& window, int count) {
  const StateId newest = window.states.rbegin()->first;
  int moved = 0;
  for (auto& [id, feature] : window.features) {
    if (moved == count || !feature.anchor || !feature.seen.contains(newest)) continue;
    feature.seen.at(newest).point.x() += 0.1;
    ++moved;
  }
  return moved;
}

TEST(RejectUnexpected, EndsTracksFarFromWhereTheImuExpectsThem) {
  TestWorld world({});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  EXPECT_THAT(reject_unexpected(window, kGenerous), IsEmpty());
  ASSERT_EQ(move_newest_observations(window, 10), 10);
  EXPECT_EQ(reject_unexpected(window, kGenerous).size(), 10U);
  EXPECT_THAT(reject_unexpected(window, kGenerous), IsEmpty());
}

TEST(RejectUnexpected, DoubtsThePredictionWhenItFitsTheLesserPartOnly) {
  TestWorld world({});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  move_newest_observations(window, 1000);
  EXPECT_THAT(reject_unexpected(window, kGenerous), IsEmpty());
}

TEST(MoveAnchor, KeepsThePlaceInTheWorld) {
  TestWorld world({.cameras = 2});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  int moved = 0;
  for (auto& [id, feature] : window.features) {
    if (!feature.anchor) continue;
    const Eigen::Vector3d before = window.position(feature);
    const StateId to = feature.seen.rbegin()->first;
    ASSERT_TRUE(move_anchor(window, feature, to, kGenerous));
    EXPECT_EQ(*feature.anchor, to);
    // The ray is the new anchor's own observation, half a pixel beside the old one's: the depth is kept.
    const double depth = (window.T_W_C(to, feature.camera).inverse() * before).z();
    EXPECT_NEAR(1.0 / feature.inverse_depth, depth, 1e-9);
    EXPECT_LT((window.position(feature) - before).norm(), 8.0 * 0.5 / 200.0 * depth);
    ++moved;
  }
  EXPECT_GT(moved, 80);
}

TEST(MoveAnchor, MakesAPlainTrackOfALandmarkThatWouldLieOutOfBounds) {
  TestWorld world({.pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  Feature& feature = window.features.at(seen_by_all(window));
  EXPECT_FALSE(move_anchor(window, feature, feature.seen.rbegin()->first, {.max_depth_m = 1.0}));
  EXPECT_FALSE(feature.anchor.has_value());
}

}  // namespace
}  // namespace edged
