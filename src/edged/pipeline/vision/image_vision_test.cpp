// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Vision without an estimator: images of a plane, moved by a known motion.
#include "edged/pipeline/vision/image_vision.hpp"

#include <gtest/gtest.h>

#include <set>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

Timestamp at_image(int image) { return timestamp_from_ns(40'000'000LL * (image + 1)); }

/// A camera with the frame of the body, moving sideways in front of a plane 2 m away.
class PlaneVision : public testing::Test {
 protected:
  PlaneVision() {
    rig_.name = "plane";
    rig_.cameras.push_back({"cam", Modality::Frames, scene_.camera(), SE3(), Duration(0)});
  }

  static SE3 pose(int image) { return {so3::exp({0, 0.002 * image, 0}), {0.01 * image, 0.004 * image, 0}}; }

  Packet packet(int image) const {
    Packet packet;
    packet.t = at_image(image);
    packet.imu.resize(2);
    packet.imu.front().t = at_image(image - 1);
    packet.imu.back().t = packet.t;
    return packet;
  }

  VisionOutput show(Vision& vision, int image) {
    Packet shown = packet(image);
    shown.frames.push_back({shown.t, "cam", scene_.image(pose(image))});
    return process(vision, shown, image);
  }

  VisionOutput process(Vision& vision, const Packet& packet, int image) {
    body_.predict(packet.imu, true);
    OdomState state;
    state.t = packet.t;
    state.T_O_B = pose(image);
    body_.correct(state);
    return vision.process({packet, body_});
  }

  /// All live tracks are landmarks at that depth.
  VisionCorrection landmarks_at(double depth_m, const VisionOutput& output) const {
    VisionCorrection correction{{}, LandmarkDepths(1), rig_.cameras};
    for (const Track& track : output.images.front().tracks) correction.landmarks->front().emplace(track.id, depth_m);
    return correction;
  }

  PlaneScene scene_{davis_like_pinhole(), 2.0};
  Rig rig_;
  StageTimings timings_;
  ImuPropagator body_{ImuNoise{}, std::chrono::milliseconds(250)};
};

TEST_F(PlaneVision, ObservesFeaturesWhereTheMotionPutsThem) {
  ImageVision vision(rig_, {}, Inference::Synchronous, timings_);
  const VisionOutput first = show(vision, 0);
  EXPECT_TRUE(first.keyframe);
  const std::vector<FeatureObservation> before = first.observations.front().features;
  ASSERT_GT(before.size(), 50U);
  int found = 0;
  for (int image = 1; image <= 8; ++image) {
    vision.correct({{}, std::nullopt}, body_);
    const VisionOutput now = show(vision, image);
    if (image < 8) continue;
    ASSERT_EQ(now.observations.size(), 1U);
    for (const FeatureObservation& observation : now.observations.front().features) {
      const auto then = std::ranges::find(before, observation.id, &FeatureObservation::id);
      if (then == before.end()) continue;
      const CameraModel& camera = scene_.camera();
      const auto pixel = scene_.moved(*camera.project(then->point.homogeneous()), pose(0), pose(image));
      EXPECT_LT((*pixel - *camera.project(observation.point.homogeneous())).norm(), 1.0) << observation.id;
      ++found;
    }
  }
  EXPECT_GT(found, 40);
}

TEST_F(PlaneVision, TakesTheSceneDepthFromLandmarksAndGivesItUpWithTheEstimate) {
  OdometryConfig config;
  config.depth.constant_m = 5.0;
  ImageVision vision(rig_, config, Inference::Synchronous, timings_);
  VisionOutput output = show(vision, 0);
  EXPECT_EQ(output.scene_depth, 5.0);
  for (int image = 1; image <= 10; ++image) {
    vision.correct(landmarks_at(2.0, output), body_);
    output = show(vision, image);
  }
  EXPECT_NEAR(output.scene_depth, 2.0, 0.1);
  for (int image = 11; image <= 50; ++image) {
    vision.correct({{}, std::nullopt}, body_);
    output = process(vision, packet(image), image);
  }
  EXPECT_EQ(output.scene_depth, 5.0) << "the measurement is too old";
}

TEST_F(PlaneVision, EndsTracksThatLocalizationFindsWrong) {
  ImageVision vision(rig_, {}, Inference::Synchronous, timings_);
  const VisionOutput first = show(vision, 0);
  const FeatureId wrong = first.images.front().tracks.front().id;
  vision.correct({{wrong}, std::nullopt}, body_);
  const VisionOutput second = show(vision, 1);
  for (const Track& track : second.images.front().tracks) EXPECT_NE(track.id, wrong);
}

TEST_F(PlaneVision, ObservesNothingWithoutAnImageAndKeepsItsTracks) {
  ImageVision vision(rig_, {}, Inference::Synchronous, timings_);
  const std::size_t tracks = show(vision, 0).images.front().tracks.size();
  const VisionOutput output = process(vision, packet(1), 1);
  EXPECT_FALSE(output.keyframe);
  EXPECT_TRUE(output.observations.empty());
  EXPECT_TRUE(output.images.front().image.empty());
  EXPECT_EQ(output.images.front().tracks.size(), tracks);
}

TEST_F(PlaneVision, BeginsANewTimeWithNewFeatures) {
  ImageVision vision(rig_, {}, Inference::Synchronous, timings_);
  std::set<FeatureId> before;
  const VisionOutput first = show(vision, 0);
  for (const Track& track : first.images.front().tracks) before.insert(track.id);
  vision.begin_epoch();
  const VisionOutput output = show(vision, 1);
  EXPECT_TRUE(output.keyframe);
  for (const Track& track : output.images.front().tracks) EXPECT_FALSE(before.contains(track.id));
}

TEST_F(PlaneVision, RendersNoEventFrameOfTooFewEvents) {
  rig_.cameras = {{"dvs", Modality::Events, scene_.camera(), SE3(), Duration(0)}};
  ImageVision vision(rig_, {}, Inference::Synchronous, timings_);
  Packet few = packet(0);
  few.events.push_back({"dvs", {{few.t, 10, 10, true}}, 1, 1, 25.0});
  const VisionOutput output = process(vision, few, 0);
  EXPECT_TRUE(output.events_static);
  EXPECT_TRUE(output.event_images.front().frame.empty());
  EXPECT_TRUE(output.observations.empty());
  const std::vector<CameraStep> cameras = vision.describe(few, output);
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras.front().events.size(), 1U);
  EXPECT_EQ(cameras.front().rendered, 0U);
}

TEST_F(PlaneVision, ObservesNothingInAnEventFrameOfNoise) {
  rig_.cameras = {{"dvs", Modality::Events, scene_.camera(), SE3(), Duration(0)}};
  ImageVision vision(rig_, {}, Inference::Synchronous, timings_);
  const auto width = static_cast<unsigned>(scene_.camera().width()),
             height = static_cast<unsigned>(scene_.camera().height());
  const std::size_t count = width * height / 4U;
  for (int image = 0; image < 3; ++image) {
    Packet noise = packet(image);
    PacketEvents events{"dvs", {}, count, count, 25.0 * static_cast<double>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = (i + static_cast<std::size_t>(image) * count) * 0x9e3779b97f4a7c15U >> 24U;
      events.events.push_back({noise.t - Duration(static_cast<std::int64_t>(count - i)),
                               static_cast<std::uint16_t>(place % width),
                               static_cast<std::uint16_t>(place / width % height), i % 3 == 0});
    }
    noise.events.push_back(std::move(events));
    const VisionOutput output = process(vision, noise, image);
    if (image == 0) continue;  // no motion is known yet
    EXPECT_FALSE(output.event_images.front().frame.empty()) << "it is shown";
    EXPECT_TRUE(output.events_static) << "motion would show";
    EXPECT_TRUE(output.observations.empty());
    EXPECT_FALSE(output.keyframe);
  }
}

TEST_F(PlaneVision, GivesTheFeaturesOfTwoCamerasOneIdEach) {
  const SE3 beside(so3::exp({0.0, 0.01, 0.0}), {0.1, 0.0, 0.0});
  rig_.cameras.push_back({"beside", Modality::Frames, scene_.camera(), beside, Duration(0)});
  for (const bool enabled : {true, false}) {
    OdometryConfig config;
    config.stereo.enabled = enabled;
    ImageVision vision(rig_, config, Inference::Synchronous, timings_);
    std::size_t shared = 0, of_one = 0;
    for (int image = 0; image < 6; ++image) {
      Packet both = packet(image);
      both.frames.push_back({both.t, "cam", scene_.image(pose(image))});
      both.frames.push_back({both.t, "beside", scene_.image(pose(image) * beside)});
      const VisionOutput output = process(vision, both, image);
      ASSERT_EQ(output.observations.size(), 2U);
      of_one = output.observations[0].features.size();
      shared = 0;
      for (const FeatureObservation& feature : output.observations[0].features) {
        const auto there = std::ranges::find(output.observations[1].features, feature.id, &FeatureObservation::id);
        if (there == output.observations[1].features.end()) continue;
        ++shared;
        const auto pixel =
            scene_.moved(*scene_.camera().project(feature.point.homogeneous()), pose(image), pose(image) * beside);
        EXPECT_LT((*pixel - *scene_.camera().project(there->point.homogeneous())).norm(), 1.0) << feature.id;
      }
      vision.correct({{}, std::nullopt}, body_);
    }
    if (enabled) {
      EXPECT_GT(shared, of_one / 2);
    } else {
      EXPECT_EQ(shared, 0U);
    }
  }
}

}  // namespace
}  // namespace edged
