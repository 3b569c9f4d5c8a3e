// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Counts, findings and estimates of a recording.
#include "edged/checks/statistics/survey.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

namespace edged {
namespace {

Timestamp at(double seconds) { return timestamp_from_seconds(seconds); }

TEST(StreamSurveyor, CountsRateAndTheLongestGaps) {
  StreamSurveyor surveyor;
  for (int i = 0; i < 1000; ++i)
    if (i < 300 || i >= 340) surveyor.add(at(i * 0.005), at(i * 0.005));
  const StreamSurvey survey = surveyor.result();
  EXPECT_EQ(survey.count, 960u);
  EXPECT_EQ(survey.typical_step, std::chrono::milliseconds(5));
  ASSERT_EQ(survey.gaps, 1u);
  EXPECT_NEAR(to_seconds(survey.longest[0].after), 1.495, 1e-9);
  EXPECT_NEAR(to_seconds(survey.missing), 0.205, 1e-9);
  EXPECT_NEAR(survey.rate_hz(), 959 / 4.995, 1e-6);
}

TEST(StreamSurveyor, JudgesShortStreamsToo) {
  StreamSurveyor surveyor;
  for (const double t : {0.0, 0.1, 0.2, 0.9}) surveyor.add(at(t), at(t));
  EXPECT_EQ(surveyor.result().gaps, 1u);
  EXPECT_EQ(StreamSurveyor().result().count, 0u);
}

TEST(EventSurveyor, FindsHotPixelsRatesAndExtent) {
  EventSurveyor surveyor(cv::Size(32, 24));
  std::vector<Event> events;
  for (int i = 0; i < 20'000; ++i)
    events.push_back(
        {at(i * 1e-5), static_cast<std::uint16_t>(i % 32), static_cast<std::uint16_t>(i / 32 % 20), i % 4 > 0});
  for (int i = 0; i < 5000; ++i) events.push_back({at(0.2 + i * 1e-5), 7, 9, true});
  events.push_back({at(1.0), 0, 0, true});
  surveyor.add(events);
  const EventSurvey survey = surveyor.result();
  EXPECT_EQ(survey.extent, cv::Size(32, 20));
  ASSERT_EQ(survey.hot_pixels, 1u);
  EXPECT_EQ(survey.hottest[0].x, 7);
  EXPECT_EQ(survey.hottest[0].y, 9);
  EXPECT_NEAR(survey.hot_share, 5031.0 / 25'001, 1e-3);
  EXPECT_NEAR(survey.active_share, 640.0 / 768, 1e-9);
  EXPECT_NEAR(survey.peak_rate_hz, 1e5, 200);
  EXPECT_NEAR(survey.rate_shares[0], 0.75, 0.02);  // silent from 0.25 s on
  EXPECT_NEAR(survey.positive_share, (15'000.0 + 5001) / 25'001, 1e-9);
}

TEST(ImuSurveyor, EstimatesNoiseAtRestOfWhiteNoise) {
  constexpr double kGyro = 2e-3, kAccel = 3e-2, kRate = 500;  // densities
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double density) -> Eigen::Vector3d {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)) * density * std::sqrt(kRate);
  };
  ImuSurveyor surveyor;
  for (int i = 0; i < 2000; ++i) {
    const double t = i / kRate, moving = t < 2.0 ? std::sin(4 * std::numbers::pi * t) : 0.0;
    surveyor.add({at(t), Eigen::Vector3d(0.1 + moving, 0, 0) * 0.2 + noise(kGyro) * 0.2,
                  Eigen::Vector3d(0, 0, 9.81 + moving) + noise(kAccel) * 0.2});
  }
  const ImuSurvey survey = surveyor.result();
  ASSERT_TRUE(survey.rest);
  EXPECT_GE(survey.rest->begin, at(1.99));
  EXPECT_GE(survey.rest->length, std::chrono::milliseconds(1500));
  EXPECT_NEAR(survey.rest->gyro_noise / (0.2 * kGyro), 1.0, 0.15);
  EXPECT_NEAR(survey.rest->accel_noise / (0.2 * kAccel), 1.0, 0.15);
  EXPECT_NEAR(survey.rest->gyro.x(), 0.02, 2e-3);
  EXPECT_NEAR(survey.mean_accel, 9.81, 0.05);
}

/// Rate 1 kHz, with a first-order filter at 40 Hz, as in many IMUs.
TEST(ImuSurveyor, EstimatesTheNoiseOfAnImuThatFiltersIt) {
  constexpr double kDensity = 1e-4, kRate = 1000;
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  Eigen::Vector3d filtered = Eigen::Vector3d::Zero();
  ImuSurveyor surveyor;
  for (int i = 0; i < 8000; ++i) {
    const Eigen::Vector3d white =
        Eigen::Vector3d(normal(random), normal(random), normal(random)) * kDensity * std::sqrt(kRate);
    filtered += 2 * std::numbers::pi * 40 / kRate * (white - filtered);
    surveyor.add({at(i / kRate), filtered, {0, 0, 9.81}});
  }
  ASSERT_TRUE(surveyor.result().rest);
  EXPECT_NEAR(surveyor.result().rest->gyro_noise / kDensity, 0.95, 0.1);
}

TEST(ImuSurveyor, TakesNoHandAndNoSteadyTurnForRest) {
  for (const double steady : {0.0, 1.0}) {
    ImuSurveyor surveyor;
    for (int i = 0; i < 2000; ++i) {
      const double tremor = (1 - steady) * 0.03 * std::sin(2 * std::numbers::pi * 4 * i / 500.0);
      surveyor.add({at(i / 500.0), {tremor, 0, steady}, {0, 0, 9.81}});
    }
    EXPECT_TRUE(surveyor.result().calm);
    EXPECT_FALSE(surveyor.result().rest);
  }
}

TEST(ImuSurveyor, TakesASteadyRateForABiasOnlyWhereThePictureStands) {
  for (const bool moves : {false, true}) {
    ImuSurveyor surveyor;
    for (int i = 0; i < 2000; ++i) {
      if (moves && i % 100 == 0) surveyor.image_moves();
      surveyor.add({at(i / 500.0), {0, 0, 0.105}, {0, 0, 9.81}});
    }
    EXPECT_EQ(surveyor.result().rest.has_value(), !moves);
  }
}

TEST(ImuSurveyor, NoticesSensorsAndAxesThatRepeatThemselves) {
  ImuSurveyor surveyor;
  for (int i = 0; i < 1000; ++i) {
    const double x = std::sin(i), held = i < 400 ? x : 0.5;
    surveyor.add({at(i / 500.0), {0, 0, 0}, {held, held, 9.81}});
  }
  const ImuSurvey survey = surveyor.result();
  EXPECT_TRUE(survey.gyro_frozen.dead());
  EXPECT_FALSE(survey.accel_frozen.dead() || survey.accel_frozen.dead(0));
  EXPECT_TRUE(survey.accel_frozen.dead(2));
  EXPECT_NEAR(to_seconds(survey.accel_frozen.longest), 1.198, 1e-9);
  EXPECT_EQ(survey.accel_frozen.since, at(0.8));
}

TEST(ImuSurveyor, SaysNothingOfNoiseFromTooFewSamples) {
  ImuSurveyor surveyor;
  EXPECT_FALSE(surveyor.result().calm);
  surveyor.add({.t = at(0), .accel_B = {0, 0, 9.81}});
  EXPECT_FALSE(surveyor.result().calm);
  EXPECT_NEAR(surveyor.result().mean_accel, 9.81, 1e-9);
}

TEST(EventSurveyor, SurvivesAnySensorAndOneEvent) {
  for (const cv::Size& sensor : {cv::Size(), cv::Size(1, 1), cv::Size(65536, 65536), cv::Size(346, 8388868)}) {
    EventSurveyor surveyor(sensor);
    EXPECT_EQ(surveyor.result().extent, cv::Size());
    const std::vector<Event> one{{at(1), 65535, 65535, true}, {at(1), 0, 0, true}};
    surveyor.add(one);
    EXPECT_EQ(surveyor.result().extent, cv::Size(65536, 65536));
    EXPECT_EQ(surveyor.result().hot_pixels, 0u);
  }
}

/// Ten seconds of a moving texture, at up to 40 Hz in all pixels, without rest.
TEST(EventSurveyor, FindsHotPixelsSlowerThanTheSceneAndNoOthers) {
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
    EventSurveyor surveyor(sensor);
    surveyor.add(events);
    const EventSurvey survey = surveyor.result();
    ASSERT_EQ(survey.hot_pixels, 3u);
    EXPECT_EQ(survey.hottest[0].x, 50);
    EXPECT_NEAR(survey.hottest[0].rate_hz, 200.0, 15.0);
    EXPECT_EQ(survey.hottest[1].x, 11);
    EXPECT_EQ(survey.hottest[2].x, 10);
  }
}

TEST(EventSurveyor, ABurstIsNoHotPixelAndAMomentTellsNone) {
  std::vector<Event> events;
  std::mt19937 random(4);
  for (int i = 0; i < 8000; ++i)  // a still scene with some noise, and two pixels of which one fires for 0.1 s only
    events.push_back(
        {at(i * 5e-4), static_cast<std::uint16_t>(random() % 60), static_cast<std::uint16_t>(random() % 40), true});
  for (int i = 0; i < 60; ++i) events.push_back({at(1.0 + i * 0.0015), 5, 5, true});
  for (int i = 0; i < 60; ++i) events.push_back({at(0.5 + i * 0.05), 25, 25, true});
  std::ranges::sort(events, {}, &Event::t);
  EventSurveyor whole(cv::Size(60, 40)), moment(cv::Size(60, 40));
  whole.add(events);
  ASSERT_EQ(whole.result().hot_pixels, 1u);
  EXPECT_EQ(whole.result().hottest[0].x, 25);
  EXPECT_TRUE(whole.result().hot_known);
  moment.add(std::span(events).first(900));
  EXPECT_FALSE(moment.result().hot_known);
}

TEST(EventSurveyor, AThingThatMovesIsNotMadeOfHotPixels) {
  EventSurveyor surveyor(cv::Size(100, 100));
  std::vector<Event> events;
  for (int i = 0; i < 1000; ++i) events.push_back({at(i * 1e-3), static_cast<std::uint16_t>(i % 100), 90, true});
  for (int i = 0; i < 40'000; ++i)
    events.push_back(
        {at(1 + i * 1e-4), static_cast<std::uint16_t>(20 + i % 30), static_cast<std::uint16_t>(20 + i / 30 % 3), true});
  surveyor.add(events);
  EXPECT_EQ(surveyor.result().hot_pixels, 0u);
}

TEST(Survey, OverlapIsTheTimeThatAllSensorsCover) {
  Surveyor surveyor({});
  for (int i = 0; i <= 10; ++i) surveyor.add(ImuSample{.t = at(i)});
  surveyor.add(EventBatch{"events", {{at(4), 0, 0, true}, {at(14), 0, 0, true}}});
  struct Empty : Dataset {
    const DatasetInfo& info() const override { return info_; }
    std::optional<Measurement> next() override { return std::nullopt; }
    DatasetInfo info_;
  } dataset;
  EXPECT_EQ(surveyor.result(dataset, std::nullopt).overlap(), std::chrono::seconds(6));
}

}  // namespace
}  // namespace edged
