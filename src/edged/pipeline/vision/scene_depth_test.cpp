// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/scene_depth.hpp"

#include <gtest/gtest.h>

#include <random>

namespace edged {
namespace {

RigCamera camera(Modality modality) {
  return {modality == Modality::Events ? "events" : "frames", modality, CameraModel(240, 180, 200, 200, 119.5, 89.5),
          SE3(), Duration(0)};
}

/// A second of events all over the image.
std::vector<Event> events() {
  std::mt19937 random(1);
  std::vector<Event> out;
  for (int i = 0; i < 200'000; ++i) {
    out.push_back({timestamp_from_seconds(5e-6 * i), static_cast<std::uint16_t>(random() % 240),
                   static_cast<std::uint16_t>(random() % 180), random() % 2 == 0});
  }
  return out;
}

std::vector<SeenDepth> landmarks(double depth_m) {
  return std::vector<SeenDepth>(20, SeenDepth{{0.01, 0.02}, depth_m});
}

TEST(SceneDepth, IsTheConstantUntilLandmarksTell) {
  DepthConfig config;
  config.constant_m = 1.5;
  SceneDepth depth(config, camera(Modality::Events), false);
  EXPECT_EQ(depth.at(timestamp_from_seconds(0.1)), 1.5);
  depth.add_landmarks(timestamp_from_seconds(0.1), landmarks(3.0));
  EXPECT_DOUBLE_EQ(depth.at(timestamp_from_seconds(0.1)), 3.0);
}

TEST(SceneDepth, GivesTheFactorTheNetworkAndNeverTheLandmarks) {
  const Timestamp t = timestamp_from_seconds(1.0);
  SceneDepth depth(DepthConfig(), camera(Modality::Events), true);
  depth.add_landmarks(t, landmarks(3.0));
  EXPECT_FALSE(depth.for_factor(t));
  depth.add_events(events());
  const std::optional<RegionDepth> first = depth.for_factor(t);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->camera, "events");
  EXPECT_LT(first->low.x(), 0.0);
  EXPECT_GT(first->high.y(), 0.0);
  depth.add_landmarks(t, landmarks(0.7));
  EXPECT_EQ(depth.for_factor(t)->depth_m, first->depth_m);
  EXPECT_FALSE(depth.for_factor(t + std::chrono::milliseconds(700)));  // held, not measured
}

TEST(SceneDepth, HasNothingForTheFactorWithoutEventsOrUnasked) {
  const Timestamp t = timestamp_from_seconds(1.0);
  SceneDepth unasked(DepthConfig(), camera(Modality::Events), false);
  unasked.add_events(events());
  EXPECT_FALSE(unasked.for_factor(t));
  SceneDepth frames(DepthConfig(), camera(Modality::Frames), true);
  EXPECT_FALSE(frames.for_factor(t));
}

}  // namespace
}  // namespace edged
