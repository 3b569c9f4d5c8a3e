// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/camera_tracker.hpp"

#include <gtest/gtest.h>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

class ChannelHealth : public testing::Test {
 protected:
  ChannelHealth() : scene_(davis_like_pinhole(), 2.0) {
    camera_.name = "left";
    camera_.modality = Modality::Frames;
  }

  CameraTracker start() {
    CameraTracker tracker(camera_, scene_.camera(), {}, {}, {});
    show(tracker, scene_.image({}), 0);
    tracker.features->detect(scene_.image({}), next_id_, 1000);
    tracker.mark_keyframe({});
    return tracker;
  }

  static void show(CameraTracker& tracker, const cv::Mat& image, int index) {
    tracker.track(image, timestamp_from_ns(40'000'000LL * index), {}, {}, std::nullopt);
  }

  /// An image of new noise at every call.
  cv::Mat darkness() {
    cv::Mat image(scene_.camera().height(), scene_.camera().width(), CV_8UC1);
    random_.fill(image, cv::RNG::NORMAL, 8, 4);
    return image;
  }

  PlaneScene scene_;
  RigCamera camera_;
  FeatureId next_id_ = 1;
  cv::RNG random_{7};
};

TEST_F(ChannelHealth, ObservationsOfTracksThatSurviveKeepTheirSigma) {
  CameraTracker tracker = start();
  for (int i = 1; i <= 10; ++i) show(tracker, scene_.image({}), i);
  EXPECT_DOUBLE_EQ(tracker.survival_rate(), 1.0);
  const CameraObservations raw = tracker.features->observations(), weighed = tracker.observations();
  ASSERT_GT(weighed.features.size(), 50U);
  EXPECT_DOUBLE_EQ(weighed.features[0].sigma, raw.features[0].sigma);
}

TEST_F(ChannelHealth, ACameraThatLosesItsTracksCountsLessAndThenNothing) {
  CameraTracker tracker = start();
  show(tracker, darkness(), 1);
  const double after_one = tracker.survival_rate();
  EXPECT_LT(after_one, 1.0);
  for (int i = 2; i <= 30; ++i) {
    tracker.features->detect(darkness(), next_id_, 1000);
    tracker.mark_keyframe({});
    show(tracker, darkness(), i);
  }
  EXPECT_LT(tracker.survival_rate(), HealthConfig{}.min_survival_rate);
  EXPECT_TRUE(tracker.observations().features.empty());
}

TEST_F(ChannelHealth, ACameraThatSeesAgainIsTrustedAgain) {
  CameraTracker tracker = start();
  for (int i = 1; i <= 30; ++i) {
    tracker.features->detect(darkness(), next_id_, 1000);
    tracker.mark_keyframe({});
    show(tracker, darkness(), i);
  }
  for (int i = 31; i <= 80; ++i) {
    show(tracker, scene_.image({}), i);
    tracker.features->detect(scene_.image({}), next_id_, 1000);
    tracker.mark_keyframe({});
  }
  EXPECT_GT(tracker.survival_rate(), 0.95);
  EXPECT_FALSE(tracker.observations().features.empty());
}

TEST_F(ChannelHealth, NoMoreCornersThanWanted) {
  CameraTracker tracker(camera_, scene_.camera(), {}, {}, {});
  show(tracker, scene_.image({}), 0);
  tracker.features->detect(scene_.image({}), next_id_, 25);
  tracker.mark_keyframe({});
  EXPECT_EQ(tracker.features->tracks().size(), 25U);
  tracker.features->detect(scene_.image({}), next_id_, 10);
  tracker.mark_keyframe({});
  EXPECT_EQ(tracker.features->tracks().size(), 25U) << "live tracks stay";
}

TEST_F(ChannelHealth, TheCameraThatCarriesMoreTracksLeads) {
  const cv::Mat image = scene_.image({});
  CameraTracker few(camera_, scene_.camera(), {}, {}, {}), many(camera_, scene_.camera(), {}, {}, {});
  for (CameraTracker* tracker : {&few, &many}) show(*tracker, image, 0);
  few.features->detect(image, next_id_, 40);
  many.features->detect(image, next_id_, 1000);
  const std::vector<CameraImage> views = {{&many, image, image}, {&few, image, image}};
  EXPECT_EQ(leading_tracker({}), nullptr);
  EXPECT_EQ(leading_tracker(views), &many);
  EXPECT_EQ(leading_tracker(std::span(views).last(1)), &few) << "the other one has no image now";
  show(many, darkness(), 1);
  EXPECT_EQ(leading_tracker(views), &few) << "the other one has lost its tracks";
}

}  // namespace
}  // namespace edged
