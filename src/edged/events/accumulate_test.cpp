// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Event frames of hand-made events, and of generated ones that follow points of a moving scene.
#include "edged/events/accumulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "edged/core/check.hpp"
#include "edged/events/test_support.hpp"

namespace edged {
namespace {

const CameraModel kCamera(120, 90, 100.0, 100.0, 59.5, 44.5);
const CameraModel kDistorted(120, 90, 100.0, 100.0, 61.0, 46.0, DistortionModel::RadTan,
                             {-0.3, 0.1, 0.001, -0.0005, 0});

Timestamp at_us(std::int64_t us) { return Timestamp(std::chrono::microseconds(us)); }

/// Pure translation so that the events at time 0 move by the given pixels at a depth of 1 m.
CameraMotion shift_by(double dx_px, double dy_px) {
  const Eigen::Vector3d t(dx_px / kCamera.fx(), dy_px / kCamera.fy(), 0.0);
  return CameraMotion{{{at_us(0), SE3(Eigen::Quaterniond::Identity(), t)}}};
}

cv::Mat accumulate_once(const std::vector<Event>& events, const CameraMotion& motion) {
  EventFrameRenderer renderer(UndistortTable(kCamera, kCamera), EventFrameConfig());
  return renderer.accumulate(events, motion, 1.0).clone();
}

TEST(EventFrame, SpreadsAnEventOverItsFourPixelNeighbours) {
  const cv::Mat sum = accumulate_once({{at_us(0), 20, 30, true}}, shift_by(0.25, 0.5));
  EXPECT_NEAR(sum.at<float>(30, 20), 0.75 * 0.5, 1e-4);
  EXPECT_NEAR(sum.at<float>(30, 21), 0.25 * 0.5, 1e-4);
  EXPECT_NEAR(sum.at<float>(31, 20), 0.75 * 0.5, 1e-4);
  EXPECT_NEAR(sum.at<float>(31, 21), 0.25 * 0.5, 1e-4);
  EXPECT_NEAR(cv::sum(sum)[0], 1.0, 1e-5);
}

TEST(EventFrame, CountsOnlyTheShareOfAnEventThatIsInsideTheImage) {
  EXPECT_NEAR(cv::sum(accumulate_once({{at_us(0), 0, 10, true}}, shift_by(-0.25, 0)))[0], 0.75, 1e-4);
  EXPECT_NEAR(cv::sum(accumulate_once({{at_us(0), 119, 89, true}}, shift_by(0.5, 0.5)))[0], 0.25, 1e-4);
  EXPECT_EQ(cv::sum(accumulate_once({{at_us(0), 119, 89, true}}, shift_by(1.5, 0)))[0], 0.0);
  EXPECT_EQ(cv::sum(accumulate_once({{at_us(0), 0, 0, true}}, shift_by(-500, -500)))[0], 0.0);
}

TEST(EventFrame, IgnoresPolarity) {
  const cv::Mat sum = accumulate_once({{at_us(0), 5, 6, true}, {at_us(0), 5, 6, false}}, CameraMotion());
  EXPECT_EQ(sum.at<float>(6, 5), 2.0F);
}

TEST(EventFrame, SaturatesAtTheGivenNumberOfEvents) {
  std::vector<Event> events;
  for (const auto& [x, n] : {std::pair{10, 1}, std::pair{20, 2}, std::pair{30, 4}, std::pair{40, 9}}) {
    for (int i = 0; i < n; ++i) events.push_back({at_us(0), static_cast<std::uint16_t>(x), 50, true});
  }
  EventFrameConfig config;
  config.saturation_events = 4.0;
  config.blur_sigma_px = 0.0;
  const cv::Mat frame =
      EventFrameRenderer(UndistortTable(kCamera, kCamera), config).render(events, CameraMotion(), 1.0).image;
  ASSERT_EQ(frame.type(), CV_8UC1);
  EXPECT_EQ(frame.size(), cv::Size(120, 90));
  EXPECT_EQ(frame.at<unsigned char>(50, 10), 64);
  EXPECT_NEAR(frame.at<unsigned char>(50, 20), 128, 1);
  EXPECT_EQ(frame.at<unsigned char>(50, 30), 255);
  EXPECT_EQ(frame.at<unsigned char>(50, 40), 255);
  EXPECT_EQ(cv::countNonZero(frame), 4);
}

TEST(EventFrame, BlurKeepsTheSumAndLowersThePeak) {
  const std::vector<Event> events(40, Event{at_us(0), 60, 45, true});
  EventFrameConfig config;
  config.saturation_events = 255.0;
  config.blur_sigma_px = 1.0;
  const cv::Mat frame =
      EventFrameRenderer(UndistortTable(kCamera, kCamera), config).render(events, CameraMotion(), 1.0).image;
  EXPECT_NEAR(cv::sum(frame)[0], 40.0, 6.0);  // rounding to whole grey values
  EXPECT_LT(frame.at<unsigned char>(45, 60), 10);
  EXPECT_GT(frame.at<unsigned char>(45, 61), 0);
}

TEST(EventFrame, IsBlackWithoutEvents) {
  EventFrameRenderer renderer(UndistortTable(kCamera, kCamera), EventFrameConfig());
  EXPECT_EQ(cv::countNonZero(renderer.render({}, CameraMotion(), 1.0).image), 0);
}

TEST(EventFrame, ShowsTheIncrementsOfTheBrightnessBesideTheEvents) {
  EventFrameConfig config;
  config.saturation_events = 4.0;
  config.blur_sigma_px = 0.0;
  EventFrameRenderer renderer(UndistortTable(kCamera, kCamera), config);
  const Event on{at_us(0), 10, 50, true}, off{at_us(0), 20, 50, false};
  const EventFrame frame = renderer.render(
      std::vector<Event>{on, on, off, {at_us(0), 30, 50, true}, {at_us(0), 30, 50, false}}, CameraMotion(), 1.0);
  ASSERT_EQ(frame.increments.type(), CV_8UC1);
  EXPECT_EQ(frame.increments.at<unsigned char>(50, 10), 192);
  EXPECT_EQ(frame.increments.at<unsigned char>(50, 20), 96);
  EXPECT_EQ(frame.increments.at<unsigned char>(50, 30), 128);
  EXPECT_EQ(frame.image.at<unsigned char>(50, 30), 128);
  EXPECT_EQ(frame.increments.at<unsigned char>(0, 0), 128);
}

TEST(EventFrame, StartsAfreshAtEachCallAndKeepsEarlierImages) {
  EventFrameRenderer renderer(UndistortTable(kCamera, kCamera), EventFrameConfig());
  const std::vector<Event> events(4, Event{at_us(0), 60, 45, true});
  const cv::Mat first = renderer.render(events, CameraMotion(), 1.0).image;
  const cv::Mat copy = first.clone();
  renderer.render({}, CameraMotion(), 1.0);
  const cv::Mat again = renderer.render(events, CameraMotion(), 1.0).image;
  EXPECT_EQ(cv::countNonZero(first != copy), 0);
  EXPECT_EQ(cv::countNonZero(again != copy), 0);
}

/// Events at random pixels, 1 us apart.
std::vector<Event> random_events(int n, double positive_share) {
  std::mt19937_64 random(5);
  std::vector<Event> events;
  for (int i = 0; i < n; ++i) {
    events.push_back({at_us(i), static_cast<std::uint16_t>(uniform(random, 0, 120)),
                      static_cast<std::uint16_t>(uniform(random, 0, 90)), uniform(random, 0, 1) < positive_share});
  }
  return events;
}

TEST(EventFrame, HasAStructureOfOneWhereEventsAreNoise) {
  CameraMotion motion;
  motion.knots = {{at_us(0), SE3(Eigen::Quaterniond::Identity(), {0.01, 0.01, 0.0})}, {at_us(4000), SE3()}};
  for (const double blur_px : {0.0, 0.8, 1.5}) {
    for (const double positive_share : {0.5, 1.0}) {
      for (const double weight : {1.0, 2.0}) {
        EventFrameConfig config;
        config.blur_sigma_px = blur_px;
        EventFrameRenderer renderer(UndistortTable(kCamera, kCamera), config);
        const std::vector<Event> noise = random_events(4000, positive_share);
        EXPECT_NEAR(renderer.render(noise, motion, 1.0, nullptr, weight).structure, 1.0, 0.15)
            << blur_px << " " << positive_share << " " << weight;
      }
    }
  }
}

TEST(EventFrame, HasAStructureOfMoreWhereEventsLieAlongEdges) {
  std::vector<Event> events = random_events(2000, 0.5);
  for (int line = 0; line < 6; ++line)
    for (int i = 0; i < 330; ++i)
      events.push_back({at_us(2000 + i), static_cast<std::uint16_t>(10 + 20 * line), static_cast<std::uint16_t>(i % 90),
                        line % 2 == 0});
  EventFrameRenderer renderer(UndistortTable(kCamera, kCamera), EventFrameConfig());
  EXPECT_GT(renderer.render(events, CameraMotion(), 1.0).structure, 3.0);
  EXPECT_EQ(renderer.render({}, CameraMotion(), 1.0).structure, 0.0);
}

TEST(EventFrame, ListsItsOptions) {
  EventFrameConfig config;
  ConfigFields fields = ConfigFields::of(config);
  fields.set("interpolation=single_twist");
  EXPECT_EQ(config.interpolation, WarpInterpolation::SingleTwist);
  fields.set("depth=landmarks");
  EXPECT_EQ(config.depth, EventDepth::Landmarks);
  EXPECT_THROW(fields.set("saturation_events=0"), InputError);
}

/// Events of random points at the depth `depth` (at time 0) over 20 ms of a camera that moves by the twist: one event
/// whenever a point reaches another pixel.
struct GeneratedPacket {
  std::vector<Event> events;
  CameraMotion motion;  // reference: the end
};

GeneratedPacket generate(const CameraModel& camera, const Vector6d& per_s, double depth) {
  constexpr int kSteps = 400, kPoints = 150;
  constexpr std::int64_t kStepUs = 50;
  const auto T_W_C = [&](std::int64_t us) { return SE3::exp(1e-6 * static_cast<double>(us) * per_s); };
  std::mt19937_64 random(3);
  std::vector<Eigen::Vector3d> points_W;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector2d pixel(uniform(random, -20, camera.width() + 20), uniform(random, -20, camera.height() + 20));
    points_W.push_back(depth * camera.pixel_to_point(pixel).homogeneous());
  }
  GeneratedPacket packet;
  const SE3 T_ref_W = T_W_C(kSteps * kStepUs).inverse();
  std::vector<cv::Point> last(kPoints, cv::Point(-1, -1));
  for (int s = 0; s <= kSteps; ++s) {
    const std::int64_t us = s * kStepUs;
    const SE3 T_C_W = T_W_C(us).inverse();
    if (s % 20 == 0) packet.motion.knots.push_back({at_us(us), T_ref_W * T_W_C(us)});
    for (int i = 0; i < kPoints; ++i) {
      const auto pixel = camera.project(T_C_W * points_W[static_cast<std::size_t>(i)]);
      if (!pixel || !camera.contains(*pixel)) continue;
      const cv::Point rounded(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
      cv::Point& before = last[static_cast<std::size_t>(i)];
      if (before == rounded) continue;
      before = rounded;
      packet.events.push_back(
          {at_us(us), static_cast<std::uint16_t>(rounded.x), static_cast<std::uint16_t>(rounded.y), true});
    }
  }
  return packet;
}

double variance(const GeneratedPacket& packet, const CameraModel& camera, WarpInterpolation interpolation,
                double depth) {
  EventFrameConfig config;
  config.interpolation = interpolation;
  EventFrameRenderer renderer(UndistortTable(camera, ideal_pinhole(camera)), config);
  return image_variance(renderer.accumulate(packet.events, packet.motion, depth));
}

TEST(EventFrame, OfGeneratedEventsIsSharperWithTheTrueMotion) {
  for (const CameraModel& camera : {kCamera, kDistorted}) {
    for (const Vector6d& per_s : {twist(4, 0, 0, 0, 0, 0), twist(0, 0, 8, 0, 0, 0), twist(0, 0, 0, 3, 0, 0),
                                  twist(0, 0, 0, 0, 3, 0), twist(0, 0, 0, 0, 0, 10), twist(1, -1, 3, 1, -2, 6)}) {
      const GeneratedPacket packet = generate(camera, per_s, 1.5);
      const double unwarped = variance(packet, camera, WarpInterpolation::None, 1.5);
      EXPECT_GT(variance(packet, camera, WarpInterpolation::Piecewise, 1.5), 1.7 * unwarped) << per_s.transpose();
      EXPECT_GT(variance(packet, camera, WarpInterpolation::SingleTwist, 1.5), 1.7 * unwarped) << per_s.transpose();
    }
  }
}

TEST(EventFrame, IsSharpestAtTheTrueDepth) {
  const GeneratedPacket packet = generate(kDistorted, twist(5, 2, 0, 0, 0, 2), 1.5);
  double best = 0.0, best_depth = 0.0;
  for (double depth = 0.5; depth < 4.0; depth *= 1.05) {
    const double v = variance(packet, kDistorted, WarpInterpolation::Piecewise, depth);
    if (v > best) best = v, best_depth = depth;
  }
  EXPECT_NEAR(best_depth, 1.5, 0.12);
}

TEST(ImageVariance, IsTheMeanSquaredDistanceFromTheMeanOfOneChannel) {
  EXPECT_NEAR(image_variance((cv::Mat_<float>(2, 2) << 1, 3, 5, 7)), 5.0, 1e-12);
  EXPECT_NEAR(image_variance((cv::Mat_<unsigned char>(1, 4) << 0, 0, 4, 4)), 4.0, 1e-12);
  EXPECT_EQ(image_variance(cv::Mat(4, 5, CV_32F, cv::Scalar(3.0))), 0.0);
  EXPECT_EQ(image_variance(cv::Mat()), 0.0);
  EXPECT_THROW(image_variance(cv::Mat(2, 2, CV_8UC3)), CheckError);
}

}  // namespace
}  // namespace edged
