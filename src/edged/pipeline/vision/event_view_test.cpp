// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/event_view.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "edged/frontend/test_scene.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

constexpr double kSpan_s = 0.1, kDepth_m = 2.0;
constexpr int kPixels = 240 * 180;

/// Events of a packet at 0.1 s, spread evenly over the time before and over an image of that width.
PacketEvents packet_of(std::size_t events, std::size_t width = 240) {
  PacketEvents packet;
  for (std::size_t i = 0; i < events; ++i) {
    const double t_s = kSpan_s * static_cast<double>(i + 1) / static_cast<double>(events);
    const std::size_t place = i * 0x9e3779b97f4a7c15U >> 24U;  // pseudo-random
    packet.events.push_back({timestamp_from_seconds(t_s), static_cast<std::uint16_t>(place % width),
                             static_cast<std::uint16_t>(place / width % (kPixels / width)), true});
  }
  packet.window_events = packet.new_events = events;
  packet.event_rate_hz = static_cast<double>(events) / kSpan_s;
  return packet;
}

class EventViewTest : public testing::Test {
 protected:
  EventViewTest() {
    camera_.name = "events";
    camera_.model = davis_like_pinhole();
    config_.packets.window_per_pixel = 1.0;
  }

  /// A body that moves straight at that speed until the packet's time.
  static ImuPropagator moving(double speed) {
    ImuPropagator body({}, duration_from_seconds(1.0));
    OdomState state;
    state.v_O = {speed, 0, 0};
    body.correct(state);
    std::vector<ImuSample> imu;
    for (int i = 0; i <= 20; ++i) imu.push_back({timestamp_from_seconds(i * 0.005), {0, 0, 0}, {0, 0, 9.81}});
    body.predict(imu, true);
    return body;
  }

  EventImage draw(std::size_t events, double speed, bool subsample = false) {
    EventView view(camera_.model, config_);
    const PacketEvents packet = packet_of(events, static_cast<std::size_t>(camera_.model.width()));
    const ImuPropagator body = moving(speed);
    const EventsToRender rendered = view.rendered_events(packet, body, kDepth_m, subsample);
    return rendered.events.empty() ? EventImage{} : view.render(rendered, camera_, body, kDepth_m, nullptr);
  }

  RigCamera camera_;
  OdometryConfig config_;
};

TEST_F(EventViewTest, DrawsNothingOfTooFewEvents) {
  const auto least = static_cast<std::size_t>(config_.min_events_per_pixel * kPixels);
  EXPECT_TRUE(draw(least - 1, 0.0).frame.empty());
  EXPECT_EQ(draw(least - 1, 0.0).rendered, 0U);
  EXPECT_EQ(draw(least, 0.0).rendered, least);
}

TEST_F(EventViewTest, ReachesBackUntilTheSceneHasMovedFarEnough) {
  const std::size_t all = 40'000;
  EXPECT_EQ(draw(all, 0.0).rendered, all);
  // 2 m/s at 2 m and 200 px of focal length: 200 px/s, so that 5 px take a quarter of the packet's time.
  EXPECT_NEAR(static_cast<double>(draw(all, 2.0).rendered), 0.25 * all, 2.0);
  const double least = config_.min_events_per_pixel * kPixels;
  EXPECT_EQ(static_cast<double>(draw(all, 200.0).rendered), least) << "never fewer than an image needs";
}

TEST_F(EventViewTest, DrawsEachNthEventOfAWideSensorWhereAskedToAndEachForN) {
  EXPECT_EQ(cv::norm(draw(20'000, 0.0).frame, draw(20'000, 0.0, true).frame), 0.0) << "240 px are not wide";
  camera_.model = CameraModel(1200, kPixels / 1200, 200, 200, 600, 18, DistortionModel::None);
  const EventImage all = draw(20'000, 0.0);
  const EventImage thinned = draw(20'000, 0.0, true);
  EXPECT_EQ(thinned.rendered, all.rendered) << "it reaches back as far";
  cv::Scalar mean, sigma, thinned_mean, thinned_sigma;
  cv::meanStdDev(all.frame, mean, sigma);
  cv::meanStdDev(thinned.frame, thinned_mean, thinned_sigma);
  EXPECT_NEAR(thinned_mean[0], mean[0], 0.05 * mean[0]) << "as bright";
  EXPECT_GT(thinned_sigma[0], 1.2 * sigma[0]) << "and noisier";
}

TEST_F(EventViewTest, EnhancesOnlyWhereAskedTo) {
  const EventImage plain = draw(20'000, 0.0);
  EXPECT_EQ(plain.track.data, plain.frame.data);
  EXPECT_EQ(plain.detect.data, plain.frame.data);
  config_.enhance.method = EdgeMethod::Sobel;
  const EventImage enhanced = draw(20'000, 0.0);
  EXPECT_EQ(enhanced.track.data, enhanced.frame.data) << "off by default for tracking";
  EXPECT_NE(enhanced.detect.data, enhanced.frame.data);
}

TEST_F(EventViewTest, IsStaticWhereNothingMoves) {
  EventView view(camera_.model, config_);
  Timestamp t = timestamp_from_seconds(1.0);
  const auto is_static = [&](double rate_per_pixel) {
    t += duration_from_seconds(kSpan_s);
    return view.is_static(packet_of(static_cast<std::size_t>(rate_per_pixel * kPixels * kSpan_s)), t);
  };
  const double limit = kPipelineTuning.static_rate_per_pixel;
  EXPECT_TRUE(is_static(0.9 * limit));
  EXPECT_FALSE(is_static(1.1 * limit));
  EXPECT_TRUE(is_static(0.9 * limit));
  // In little light noise is less and motion causes few events: their rate rises.
  EXPECT_TRUE(is_static(0.1 * limit));
  EXPECT_TRUE(is_static(0.3 * limit));
  EXPECT_FALSE(is_static(0.9 * limit));
  t += std::chrono::seconds(20);
  EXPECT_TRUE(is_static(0.9 * limit)) << "the noise before is forgotten";
}

}  // namespace
}  // namespace edged
