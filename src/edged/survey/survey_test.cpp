// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is counted, found and estimated in a recording.
#include "edged/survey/survey.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

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
    events.push_back({at(i * 1e-5), static_cast<std::uint16_t>(i % 32), static_cast<std::uint16_t>(i / 32 % 20), i % 4 > 0});
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
  ASSERT_TRUE(survey.calm);
  EXPECT_TRUE(survey.calm->at_rest);
  EXPECT_GE(survey.calm->begin, at(1.5));
  EXPECT_NEAR(survey.calm->gyro_noise / (0.2 * kGyro), 1.0, 0.15);
  EXPECT_NEAR(survey.calm->accel_noise / (0.2 * kAccel), 1.0, 0.15);
  EXPECT_NEAR(survey.calm->gyro.x(), 0.02, 2e-3);
  EXPECT_NEAR(survey.mean_accel, 9.81, 0.05);
}

TEST(ImuSurveyor, SaysNothingOfNoiseFromTooFewSamples) {
  ImuSurveyor surveyor;
  EXPECT_FALSE(surveyor.result().calm);
  surveyor.add({.t = at(0), .accel_B = {0, 0, 9.81}});
  EXPECT_FALSE(surveyor.result().calm);
  EXPECT_NEAR(surveyor.result().mean_accel, 9.81, 1e-9);
}

TEST(EventSurveyor, SurvivesAnySensorAndOneEvent) {
  for (const cv::Size sensor : {cv::Size(), cv::Size(1, 1), cv::Size(65536, 65536), cv::Size(346, 8388868)}) {
    EventSurveyor surveyor(sensor);
    EXPECT_EQ(surveyor.result().extent, cv::Size());
    const std::vector<Event> one{{at(1), 65535, 65535, true}, {at(1), 0, 0, true}};
    surveyor.add(one);
    EXPECT_EQ(surveyor.result().extent, cv::Size(65536, 65536));
    EXPECT_EQ(surveyor.result().hot_pixels, 0u);
  }
}

TEST(EventSurveyor, AThingThatMovesIsNotMadeOfHotPixels) {
  EventSurveyor surveyor(cv::Size(100, 100));
  std::vector<Event> events;
  for (int i = 0; i < 1000; ++i) events.push_back({at(i * 1e-3), static_cast<std::uint16_t>(i % 100), 90, true});
  for (int i = 0; i < 40'000; ++i)
    events.push_back({at(1 + i * 1e-4), static_cast<std::uint16_t>(20 + i % 30), static_cast<std::uint16_t>(20 + i / 30 % 3), true});
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
  EXPECT_EQ(surveyor.result(dataset).overlap(), std::chrono::seconds(6));
}

}  // namespace
}  // namespace edged
