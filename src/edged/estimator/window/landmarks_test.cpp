// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/landmarks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// More of a flight: keyframes at the true poses, 0.2 s apart, with their observations.
struct Leg {
  int states = 6;
  bool keyframes = true;
  std::function<void(CameraObservations&)> spoil = [](CameraObservations&) {};
};

void fly(Window& window, TestWorld& world, const Leg& leg = {}) {
  for (int i = 0; i < leg.states; ++i) {
    const double t = 1.0 + 0.2 * static_cast<double>(window.states().size());
    WindowState state;
    state.t = timestamp_from_seconds(t);
    state.pose = to_block(world.T_W_B(t));
    state.keyframe = leg.keyframes;
    std::vector<CameraObservations> observations;
    for (std::size_t camera = 0; camera < world.rig().cameras.size(); ++camera) {
      leg.spoil(observations.emplace_back(world.observe(t, camera)));
    }
    window.add_state(std::move(state), observations);
  }
}

Window window_at_truth(TestWorld& world, int states = 6) {
  Window window(world.rig());
  fly(window, world, {.states = states});
  return window;
}

/// Shifts a feature's observation on the unit plane.
std::function<void(CameraObservations&)> shift(FeatureId id, double x, double y) {
  return [=](CameraObservations& view) {
    for (FeatureObservation& seen : view.features) {
      if (seen.id == id) seen.point += Eigen::Vector2d(x, y);
    }
  };
}

int count_landmarks(const Window& window) {
  return static_cast<int>(std::count_if(window.features().begin(), window.features().end(),
                                        [](const auto& entry) { return entry.second.anchor.has_value(); }));
}

constexpr LandmarkConfig kGenerous = [] {
  LandmarkConfig config;
  config.max_per_camera = 500;
  config.max_misfit = 1000.0;  // observations are tested one by one
  return config;
}();

/// A feature that all six states of such a window observe, and a landmark for it.
FeatureId lasting_corner(TestWorld& world) {
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  for (const auto& [id, feature] : window.features()) {
    if (feature.anchor && feature.observations.size() == window.states().size()) return id;
  }
  ADD_FAILURE() << "no feature stays in view";
  return 0;
}

TEST(TriangulateFeatures, PutsLandmarksWhereThePointsAreInEveryCamera) {
  TestWorld world({.cameras = 2, .pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  std::size_t landmarks[2] = {0, 0};
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    ++landmarks[feature.anchor->camera];
    EXPECT_LT((window.position(feature) - world.point_W(id)).norm(), 1e-4) << id;
  }
  EXPECT_GT(landmarks[0], 40U);
  EXPECT_GT(landmarks[1], 40U);
}

TEST(TriangulateFeatures, PlacesWhatTwoCamerasSeeAtOneInstant) {
  TestWorld world({.cameras = 2, .shared_ids = true, .pixel_noise = 0.0});
  Window window = window_at_truth(world, 1);
  triangulate_features(window, kGenerous);
  EXPECT_GT(count_landmarks(window), 20);
  for (const auto& [id, feature] : window.features()) {
    EXPECT_TRUE(!feature.anchor || feature.observations.size() == 2) << "one camera alone has no depth";
    if (!feature.anchor) continue;
    EXPECT_LT((window.position(feature) - world.point_W(id)).norm(), 1e-6) << id;
  }
}

TEST(TriangulateFeatures, WaitsForParallax) {
  TestWorld world({.speed = 0.0, .pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  // The camera sits 4 cm off the body's axis, so that rotation alone shifts it, by less than the limit.
  EXPECT_EQ(count_landmarks(window), 0);
}

TEST(TriangulateFeatures, TakesErrorsOfTracksInATurnInPlaceForNoParallax) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    TestWorld world({.speed = 0.0, .pixel_noise = 3.0, .seed = seed});
    Window window = window_at_truth(world);
    triangulate_features(window, kGenerous);
    EXPECT_EQ(count_landmarks(window), 0) << seed;
    TestWorld moves({.pixel_noise = 3.0, .seed = seed});
    Window with_parallax = window_at_truth(moves);
    triangulate_features(with_parallax, kGenerous);
    EXPECT_GT(count_landmarks(with_parallax), 30) << seed;
  }
}

TEST(TriangulateFeatures, KeepsTheBudgetOfEachCameraAndPrefersTheLongestTracks) {
  TestWorld world({.cameras = 2, .pixel_noise = 0.0});
  Window window = window_at_truth(world);
  triangulate_features(window, {.max_per_camera = 15});
  std::size_t landmarks[2] = {0, 0}, shortest_landmark[2] = {99, 99}, longest_track[2] = {0, 0};
  for (const auto& [id, feature] : window.features()) {
    const std::size_t observations = feature.observations.size(), c = feature.last_seen.begin()->first;
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

  const FeatureId id = lasting_corner(world);
  Window wrong = window_at_truth(world, 3);
  fly(wrong, world, {.states = 1, .spoil = shift(id, 0.0, 0.1)});  // 20 px
  fly(wrong, world, {.states = 2});
  triangulate_features(wrong, kGenerous);
  EXPECT_FALSE(wrong.features().at(id).anchor.has_value());
}

TEST(TriangulateFeatures, AnchorsInTheOldestKeyframe) {
  TestWorld world({.pixel_noise = 0.0});
  const FeatureId id = lasting_corner(world);
  Window window(world.rig());
  fly(window, world, {.states = 1, .keyframes = false});
  fly(window, world, {.states = 5});
  triangulate_features(window, kGenerous);
  EXPECT_EQ(window.features().at(id).anchor, (ObservationKey{std::next(window.states().begin())->first, 0}));
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
  const FeatureId id = lasting_corner(world);
  Window window = window_at_truth(world, 5);
  triangulate_features(window, kGenerous);
  fly(window, world, {.states = 1, .spoil = shift(id, 0.05, 0.0)});  // 10 px
  EXPECT_THAT(remove_outliers(window, kGenerous), ElementsAre(id));
  EXPECT_EQ(window.features().at(id).observations.size(), window.states().size() - 1);
  EXPECT_TRUE(window.features().at(id).anchor.has_value());
}

TEST(RemoveOutliers, TakesOutAnOldWrongObservationWithoutEndingTheTrack) {
  TestWorld world({.pixel_noise = 0.0});
  const FeatureId id = lasting_corner(world);
  Window window = window_at_truth(world, 3);
  triangulate_features(window, kGenerous);
  fly(window, world, {.states = 1, .spoil = shift(id, 0.05, 0.0)});
  fly(window, world, {.states = 2});
  EXPECT_THAT(remove_outliers(window, kGenerous), IsEmpty());
  EXPECT_EQ(window.features().at(id).observations.size(), window.states().size() - 1);
}

TEST(RemoveOutliers, DropsALandmarkThatFitsWorseThanTheRestInNoObservationAlone) {
  TestWorld world({});
  const FeatureId id = lasting_corner(world);
  Window window = window_at_truth(world, 3);
  triangulate_features(window, kGenerous);
  const int landmarks = count_landmarks(window);
  // It moves back and forth, by less than the limit for a single observation.
  for (const double sigmas : {4.0, -4.0, 4.0}) {
    fly(window, world, {.states = 1, .spoil = shift(id, 0.0, sigmas / 200.0)});
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
  const FeatureId tracked = lasting_corner(world);
  Window window = window_at_truth(world, 5);
  triangulate_features(window, kGenerous);
  const FeatureId ended = std::find_if(window.features().begin(), window.features().end(), [&](const auto& entry) {
                            return entry.second.anchor && entry.first != tracked;
                          })->first;
  fly(window, world, {.states = 1, .spoil = [&](CameraObservations& view) {
                        std::erase_if(view.features, [&](const auto& seen) { return seen.id == ended; });
                      }});
  for (const auto& [id, inverse_depth] : {std::pair(tracked, -0.1), std::pair(ended, 1e-4)}) {
    const double step = inverse_depth - window.features().at(id).inverse_depth;
    window.move({BlockKind::InverseDepth, id}, {&step, 1});
  }
  const std::vector<FeatureId> wrong = remove_outliers(window, kGenerous);
  EXPECT_THAT(wrong, ElementsAre(tracked));
  EXPECT_FALSE(window.features().contains(tracked));
  EXPECT_FALSE(window.features().contains(ended));
}

/// Adds a state in which `count` landmarks are observed 20 px off. Returns their number.
int fly_on_with_some_off(Window& window, TestWorld& world, int count) {
  int moved = 0;
  fly(window, world, {.states = 1, .spoil = [&](CameraObservations& view) {
                        for (FeatureObservation& seen : view.features) {
                          const auto known = window.features().find(seen.id);
                          if (moved == count || known == window.features().end() || !known->second.anchor) continue;
                          seen.point.x() += 0.1;
                          ++moved;
                        }
                      }});
  return moved;
}

TEST(RejectUnexpected, EndsTracksFarFromWhereTheImuExpectsThem) {
  TestWorld world({});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  EXPECT_THAT(reject_unexpected(window), IsEmpty());
  ASSERT_EQ(fly_on_with_some_off(window, world, 10), 10);
  EXPECT_EQ(reject_unexpected(window).size(), 10U);
  EXPECT_THAT(reject_unexpected(window), IsEmpty());
}

TEST(RejectUnexpected, DoubtsThePredictionWhenItFitsTheLesserPartOnly) {
  TestWorld world({});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  EXPECT_GT(fly_on_with_some_off(window, world, 1000), 10);
  EXPECT_THAT(reject_unexpected(window), IsEmpty());
}

TEST(InverseDepthIn, KeepsALandmarkWhereItIsInTheWorld) {
  TestWorld world({.cameras = 2});
  Window window = window_at_truth(world);
  triangulate_features(window, kGenerous);
  int moved = 0;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    const Eigen::Vector3d before = window.position(feature);
    const ObservationKey to = feature.observations.rbegin()->first;
    const auto inverse_depth = inverse_depth_in(window, to, before, kGenerous);
    ASSERT_TRUE(inverse_depth);
    window.make_landmark(id, {to, *inverse_depth});
    // The ray is the new anchor's own observation, half a pixel beside the old one's: the depth is kept.
    const double depth = (window.T_O_C(to).inverse() * before).z();
    EXPECT_NEAR(1.0 / *inverse_depth, depth, 1e-9);
    EXPECT_LT((window.position(feature) - before).norm(), 8.0 * 0.5 / 200.0 * depth);
    ++moved;
  }
  EXPECT_GT(moved, 80);
}

TEST(InverseDepthIn, IsNothingOutOfTheBounds) {
  TestWorld world({.pixel_noise = 0.0});
  const Window window = window_at_truth(world);
  const Eigen::Vector3d p_O = world.point_W(lasting_corner(world));
  EXPECT_TRUE(inverse_depth_in(window, {window.newest_id(), 0}, p_O, kGenerous));
  EXPECT_FALSE(inverse_depth_in(window, {window.newest_id(), 0}, p_O, {.max_depth_m = 1.0}));
}

}  // namespace
}  // namespace edged
