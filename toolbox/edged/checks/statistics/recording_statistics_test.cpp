// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Counts, findings and estimates of a recording.
#include "edged/checks/statistics/recording_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

namespace edged {
namespace {

Timestamp at(double seconds) { return timestamp_from_seconds(seconds); }

TEST(StreamCollector, CountsRateAndTheLongestGaps) {
  StreamCollector collector;
  for (int i = 0; i < 1000; ++i)
    if (i < 300 || i >= 340) collector.add(at(i * 0.005), at(i * 0.005));
  const StreamStatistics statistics = collector.result();
  EXPECT_EQ(statistics.count, 960u);
  EXPECT_EQ(statistics.typical_step, std::chrono::milliseconds(5));
  ASSERT_EQ(statistics.gaps, 1u);
  EXPECT_NEAR(to_seconds(statistics.longest[0].after), 1.495, 1e-9);
  EXPECT_NEAR(to_seconds(statistics.missing), 0.205, 1e-9);
  EXPECT_NEAR(statistics.rate_hz(), 959 / 4.995, 1e-6);
}

TEST(StreamCollector, JudgesShortStreamsToo) {
  StreamCollector collector;
  for (const double t : {0.0, 0.1, 0.2, 0.9}) collector.add(at(t), at(t));
  EXPECT_EQ(collector.result().gaps, 1u);
  EXPECT_EQ(StreamCollector().result().count, 0u);
}

TEST(EventCollector, FindsHotPixelsRatesAndExtent) {
  EventCollector collector(cv::Size(32, 24));
  std::vector<Event> events;
  for (int i = 0; i < 20'000; ++i)
    events.push_back(
        {at(i * 1e-5), static_cast<std::uint16_t>(i % 32), static_cast<std::uint16_t>(i / 32 % 20), i % 4 > 0});
  for (int i = 0; i < 5000; ++i) events.push_back({at(0.2 + i * 1e-5), 7, 9, true});
  events.push_back({at(1.0), 0, 0, true});
  collector.add(events);
  const EventStatistics statistics = collector.result();
  EXPECT_EQ(statistics.extent, cv::Size(32, 20));
  ASSERT_EQ(statistics.hot_pixels, 1u);
  EXPECT_EQ(statistics.hottest[0].x, 7);
  EXPECT_EQ(statistics.hottest[0].y, 9);
  EXPECT_NEAR(statistics.hot_share, 5031.0 / 25'001, 1e-3);
  EXPECT_NEAR(statistics.active_share, 640.0 / 768, 1e-9);
  EXPECT_NEAR(statistics.peak_rate_hz, 1e5, 200);
  EXPECT_NEAR(statistics.rate_shares[0], 0.75, 0.02);  // silent from 0.25 s on
  EXPECT_NEAR(statistics.positive_share, (15'000.0 + 5001) / 25'001, 1e-9);
}

TEST(RecordingCollector, CountsImagesThatAreSentSeveralTimesAndNoneAtRest) {
  const auto share = [](int times, int rest) {
    RecordingCollector collector({});
    for (int i = 0; i < 60 + rest; ++i)
      collector.add(Frame{at(0.03 * i), "cam", cv::Mat(24, 32, CV_8UC1, cv::Scalar(i < 60 ? 2 * (i / times) : 200))});
    return collector.so_far().repeated_share;
  };
  EXPECT_EQ(share(1, 0), 0.0);
  EXPECT_EQ(share(1, 100), 0.0);
  EXPECT_NEAR(share(3, 0), 2.0 / 3, 0.05);
}

TEST(ImuCollector, EstimatesNoiseAtRestOfWhiteNoise) {
  constexpr double kGyro = 2e-3, kAccel = 3e-2, kRate = 500;  // densities
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double density) -> Eigen::Vector3d {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)) * density * std::sqrt(kRate);
  };
  ImuCollector collector;
  for (int i = 0; i < 2000; ++i) {
    const double t = i / kRate, moving = t < 2.0 ? std::sin(4 * std::numbers::pi * t) : 0.0;
    collector.add({at(t), Eigen::Vector3d(0.1 + moving, 0, 0) * 0.2 + noise(kGyro) * 0.2,
                   Eigen::Vector3d(0, 0, 9.81 + moving) + noise(kAccel) * 0.2});
  }
  const ImuStatistics statistics = collector.result();
  ASSERT_TRUE(statistics.rest);
  EXPECT_GE(statistics.rest->begin, at(1.99));
  EXPECT_GE(statistics.rest->length, std::chrono::milliseconds(1500));
  EXPECT_NEAR(statistics.rest->gyro_noise / (0.2 * kGyro), 1.0, 0.15);
  EXPECT_NEAR(statistics.rest->accel_noise / (0.2 * kAccel), 1.0, 0.15);
  EXPECT_NEAR(statistics.rest->gyro.x(), 0.02, 2e-3);
  EXPECT_NEAR(statistics.mean_accel, 9.81, 0.05);
}

/// Rate 1 kHz, with a first-order filter at 40 Hz, as in many IMUs.
TEST(ImuCollector, EstimatesTheNoiseOfAnImuThatFiltersIt) {
  constexpr double kDensity = 1e-4, kRate = 1000;
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  Eigen::Vector3d filtered = Eigen::Vector3d::Zero();
  ImuCollector collector;
  for (int i = 0; i < 8000; ++i) {
    const Eigen::Vector3d white =
        Eigen::Vector3d(normal(random), normal(random), normal(random)) * kDensity * std::sqrt(kRate);
    filtered += 2 * std::numbers::pi * 40 / kRate * (white - filtered);
    collector.add({at(i / kRate), filtered, {0, 0, 9.81}});
  }
  ASSERT_TRUE(collector.result().rest);
  EXPECT_NEAR(collector.result().rest->gyro_noise / kDensity, 0.95, 0.1);
}

TEST(ImuCollector, TakesNoHandAndNoSteadyTurnForRest) {
  for (const double steady : {0.0, 1.0}) {
    ImuCollector collector;
    for (int i = 0; i < 2000; ++i) {
      const double tremor = (1 - steady) * 0.03 * std::sin(2 * std::numbers::pi * 4 * i / 500.0);
      collector.add({at(i / 500.0), {tremor, 0, steady}, {0, 0, 9.81}});
    }
    EXPECT_TRUE(collector.result().calm);
    EXPECT_FALSE(collector.result().rest);
  }
}

TEST(ImuCollector, TakesASteadyRateForABiasOnlyWhereThePictureStands) {
  for (const bool moves : {false, true}) {
    ImuCollector collector;
    for (int i = 0; i < 2000; ++i) {
      if (moves && i % 100 == 0) collector.image_moves();
      collector.add({at(i / 500.0), {0, 0, 0.105}, {0, 0, 9.81}});
    }
    EXPECT_EQ(collector.result().rest.has_value(), !moves);
  }
}

TEST(ImuCollector, NoticesSensorsAndAxesThatRepeatThemselves) {
  ImuCollector collector;
  for (int i = 0; i < 1000; ++i) {
    const double x = std::sin(i), held = i < 400 ? x : 0.5;
    collector.add({at(i / 500.0), {0, 0, 0}, {held, held, 9.81}});
  }
  const ImuStatistics statistics = collector.result();
  EXPECT_TRUE(statistics.gyro_frozen.dead());
  EXPECT_FALSE(statistics.accel_frozen.dead() || statistics.accel_frozen.dead(0));
  EXPECT_TRUE(statistics.accel_frozen.dead(2));
  EXPECT_NEAR(to_seconds(statistics.accel_frozen.longest), 1.198, 1e-9);
  EXPECT_EQ(statistics.accel_frozen.since, at(0.8));
}

TEST(ImuCollector, SaysNothingOfNoiseFromTooFewSamples) {
  ImuCollector collector;
  EXPECT_FALSE(collector.result().calm);
  collector.add({.t = at(0), .accel_B = {0, 0, 9.81}});
  EXPECT_FALSE(collector.result().calm);
  EXPECT_NEAR(collector.result().mean_accel, 9.81, 1e-9);
}

TEST(EventCollector, SurvivesAnySensorAndOneEvent) {
  for (const cv::Size& sensor : {cv::Size(), cv::Size(1, 1), cv::Size(65536, 65536), cv::Size(346, 8388868)}) {
    EventCollector collector(sensor);
    EXPECT_EQ(collector.result().extent, cv::Size());
    const std::vector<Event> one{{at(1), 65535, 65535, true}, {at(1), 0, 0, true}};
    collector.add(one);
    EXPECT_EQ(collector.result().extent, cv::Size(65536, 65536));
    EXPECT_EQ(collector.result().hot_pixels, 0u);
  }
}

/// Ten seconds of a moving texture, at up to 40 Hz in all pixels, without rest.
TEST(EventCollector, FindsHotPixelsSlowerThanTheSceneAndNoOthers) {
  std::mt19937_64 random(3);
  std::vector<Event> events;
  const auto fire = [&](int x, int y, double begin_s, double seconds, double hz) {
    for (int i = std::poisson_distribution<int>(hz * seconds)(random); i > 0; --i)
      events.push_back({at(begin_s + std::uniform_real_distribution<double>(0, seconds)(random)),
                        static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), i % 2 == 0});
  };
  for (int step = 0; step < 50; ++step)
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)  // edges that wander, and two pixels of double sensitivity
        fire(x, y, 0.2 * step, 0.2, ((x + step) % 16 < 5 ? 40.0 : 2.0) * (x == 30 && y < 2 ? 2.0 : 1.0));
  for (const auto& [x, y, hz] : {std::tuple(10, 10, 25.0), std::tuple(11, 10, 40.0), std::tuple(50, 20, 200.0)})
    fire(x, y, 0.0, 10.0, hz);
  std::ranges::sort(events, {}, &Event::t);
  for (const cv::Size& sensor : {cv::Size(64, 48), cv::Size()}) {
    EventCollector collector(sensor);
    collector.add(events);
    const EventStatistics statistics = collector.result();
    ASSERT_EQ(statistics.hot_pixels, 3u);
    EXPECT_EQ(statistics.hottest[0].x, 50);
    EXPECT_NEAR(statistics.hottest[0].rate_hz, 200.0, 15.0);
    EXPECT_EQ(statistics.hottest[1].x, 11);
    EXPECT_EQ(statistics.hottest[2].x, 10);
  }
}

TEST(EventCollector, ABurstIsNoHotPixelAndAMomentTellsNone) {
  std::vector<Event> events;
  std::mt19937 random(4);
  for (int i = 0; i < 8000; ++i)  // a still scene with some noise, and two pixels of which one fires for 0.1 s only
    events.push_back(
        {at(i * 5e-4), static_cast<std::uint16_t>(random() % 60), static_cast<std::uint16_t>(random() % 40), true});
  for (int i = 0; i < 60; ++i) events.push_back({at(1.0 + i * 0.0015), 5, 5, true});
  for (int i = 0; i < 60; ++i) events.push_back({at(0.5 + i * 0.05), 25, 25, true});
  std::ranges::sort(events, {}, &Event::t);
  EventCollector whole(cv::Size(60, 40)), moment(cv::Size(60, 40));
  whole.add(events);
  ASSERT_EQ(whole.result().hot_pixels, 1u);
  EXPECT_EQ(whole.result().hottest[0].x, 25);
  EXPECT_TRUE(whole.result().hot_known);
  moment.add(std::span(events).first(900));
  EXPECT_FALSE(moment.result().hot_known);
}

TEST(EventCollector, AThingThatMovesIsNotMadeOfHotPixels) {
  EventCollector collector(cv::Size(100, 100));
  std::vector<Event> events;
  for (int i = 0; i < 1000; ++i) events.push_back({at(i * 1e-3), static_cast<std::uint16_t>(i % 100), 90, true});
  for (int i = 0; i < 40'000; ++i)
    events.push_back(
        {at(1 + i * 1e-4), static_cast<std::uint16_t>(20 + i % 30), static_cast<std::uint16_t>(20 + i / 30 % 3), true});
  collector.add(events);
  EXPECT_EQ(collector.result().hot_pixels, 0u);
}

TEST(RecordingStatistics, OverlapIsTheTimeThatAllSensorsCover) {
  RecordingCollector collector({});
  for (int i = 0; i <= 10; ++i) collector.add(ImuSample{.t = at(i)});
  collector.add(EventBatch{"events", {{at(4), 0, 0, true}, {at(14), 0, 0, true}}});
  struct Empty : Dataset {
    const DatasetInfo& info() const override { return info_; }
    std::optional<Measurement> next() override { return std::nullopt; }
    DatasetInfo info_;
  } dataset;
  EXPECT_EQ(collector.result(dataset, std::nullopt).overlap(), std::chrono::seconds(6));
}

}  // namespace
}  // namespace edged
