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

  Channel start() {
    Channel channel(camera_, scene_.camera(), {}, {}, {});
    show(channel, scene_.image({}), 0);
    channel.tracker.detect(scene_.image({}), next_id_, 1000);
    channel.mark_keyframe({});
    return channel;
  }

  static void show(Channel& channel, const cv::Mat& image, int index) {
    channel.track(image, timestamp_from_ns(40'000'000LL * index), {}, {}, std::nullopt);
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
  Channel channel = start();
  for (int i = 1; i <= 10; ++i) show(channel, scene_.image({}), i);
  EXPECT_DOUBLE_EQ(channel.survival_rate(), 1.0);
  const CameraObservations raw = channel.tracker.observations(), weighed = channel.observations();
  ASSERT_GT(weighed.features.size(), 50U);
  EXPECT_DOUBLE_EQ(weighed.features[0].sigma, raw.features[0].sigma);
}

TEST_F(ChannelHealth, ACameraThatLosesItsTracksCountsLessAndThenNothing) {
  Channel channel = start();
  show(channel, darkness(), 1);
  const double after_one = channel.survival_rate();
  EXPECT_LT(after_one, 1.0);
  for (int i = 2; i <= 30; ++i) {
    channel.tracker.detect(darkness(), next_id_, 1000);
    channel.mark_keyframe({});
    show(channel, darkness(), i);
  }
  EXPECT_LT(channel.survival_rate(), HealthConfig{}.min_survival_rate);
  EXPECT_TRUE(channel.observations().features.empty());
}

TEST_F(ChannelHealth, ACameraThatSeesAgainIsTrustedAgain) {
  Channel channel = start();
  for (int i = 1; i <= 30; ++i) {
    channel.tracker.detect(darkness(), next_id_, 1000);
    channel.mark_keyframe({});
    show(channel, darkness(), i);
  }
  for (int i = 31; i <= 80; ++i) {
    show(channel, scene_.image({}), i);
    channel.tracker.detect(scene_.image({}), next_id_, 1000);
    channel.mark_keyframe({});
  }
  EXPECT_GT(channel.survival_rate(), 0.95);
  EXPECT_FALSE(channel.observations().features.empty());
}

TEST_F(ChannelHealth, NoMoreCornersThanWanted) {
  Channel channel(camera_, scene_.camera(), {}, {}, {});
  show(channel, scene_.image({}), 0);
  channel.tracker.detect(scene_.image({}), next_id_, 25);
  channel.mark_keyframe({});
  EXPECT_EQ(channel.tracker.tracks().size(), 25U);
  channel.tracker.detect(scene_.image({}), next_id_, 10);
  channel.mark_keyframe({});
  EXPECT_EQ(channel.tracker.tracks().size(), 25U) << "live tracks stay";
}

TEST_F(ChannelHealth, TheCameraThatCarriesMoreTracksLeads) {
  const cv::Mat image = scene_.image({});
  Channel few(camera_, scene_.camera(), {}, {}, {}), many = few;
  for (Channel* channel : {&few, &many}) show(*channel, image, 0);
  few.tracker.detect(image, next_id_, 40);
  many.tracker.detect(image, next_id_, 1000);
  const std::vector<ChannelView> views = {{&many, image, image}, {&few, image, image}};
  EXPECT_EQ(leading_channel({}), nullptr);
  EXPECT_EQ(leading_channel(views), &many);
  EXPECT_EQ(leading_channel(std::span(views).last(1)), &few) << "the other one has no image now";
  show(many, darkness(), 1);
  EXPECT_EQ(leading_channel(views), &few) << "the other one has lost its tracks";
}

}  // namespace
}  // namespace edged
