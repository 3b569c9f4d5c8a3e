// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Height and velocity in the estimator: how they bound the drift without vision, and the effect of their errors.
#include "edged/estimator/external/external_factors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/estimator/factors/height_factor.hpp"
#include "edged/estimator/factors/velocity_factor.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

constexpr double kSampleEvery_s = 0.02;
constexpr double kHeightSigma = 0.1, kVelocitySigma = 0.05;

struct Flight {
  TestWorldOptions world = {.rest_s = 1.0};
  bool height = false, velocity = false;
  double blind_from = 5.0, blind_to = 13.0, end = 13.0;  ///< [s] without vision in between
  double level = 0.0, step = 0.0, step_at = 0.0;         ///< [m] of the height sensor
  double scale = 1.0;                                    ///< scale of the velocity sensor
  double outliers = 0.0;                                 ///< share
  double gap_from = 0.0, gap_to = 0.0;                   ///< no samples
  int noise = 0;                                         ///< another number: other noise
};

struct Errors {
  double position = 0.0, height = 0.0;  ///< the largest since the start [m]
  double level = 0.0;                   ///< estimate of the height sensor, relative to the start of the body
  double scale = 0.0;                   ///< error of the estimated scale of the velocity sensor
  double observed_share = 0.0;          ///< share of the packets without vision
  bool plausible = true;
};

std::vector<ExternalSample> samples_of(const Flight& flight, TestWorld& world, double from, double to,
                                       std::mt19937_64& random) {
  std::vector<ExternalSample> samples;
  const auto wild = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 < flight.outliers; };
  for (double t = from + kSampleEvery_s / 2; t < to; t += kSampleEvery_s) {
    if (t >= flight.gap_from && t < flight.gap_to) continue;
    if (flight.height) {
      HeightSample sample = world.height(t, kHeightSigma);
      sample.height_m += flight.level + (t >= flight.step_at ? flight.step : 0.0) + (wild() ? 20.0 : 0.0);
      samples.emplace_back(sample);
    }
    if (flight.velocity) {
      VelocitySample sample = world.velocity(t, kVelocitySigma);
      sample.v_S *= flight.scale;
      if (wild()) sample.v_S += Eigen::Vector3d(4.0, -3.0, 5.0);
      samples.emplace_back(sample);
    }
  }
  return samples;
}

Errors fly(const Flight& flight) {
  TestWorld world(flight.world);
  TestWorld sensors(flight.world);  // noise of its own
  std::mt19937_64 random(5);
  for (int i = 0; i < flight.noise; ++i) world.height(0.0, 1.0), sensors.height(0.0, 1.0);
  Estimator estimator(world.rig(), world.noise(), {});
  std::optional<SE3> T_true_est;
  Errors errors;
  int blind = 0, observed = 0;
  for (int i = 1; i * kPacket_s <= flight.end; ++i) {
    const double t = i * kPacket_s;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    const bool sees = t < flight.blind_from || t >= flight.blind_to;
    if (!sees) {
      for (CameraObservations& view : input.observations) view.features.clear();
      input.keyframe = input.events_quiet = false;
    }
    input.external = samples_of(flight, sensors, t - kPacket_s, t, random);
    const EstimatorResult result = estimator.add(input);
    if (!estimator.initialized()) continue;
    const SE3 truth = world.T_W_B(t), estimate = estimator.newest().T_O_B;
    if (!T_true_est) T_true_est = alignment_at(truth, estimate);
    const Eigen::Vector3d error = (*T_true_est * estimate).translation() - truth.translation();
    errors.position = std::max(errors.position, error.norm());
    errors.height = std::max(errors.height, std::abs(error.z()));
    errors.plausible = errors.plausible && result.plausible;
    if (!sees) ++blind, observed += result.velocity_observed;
  }
  const auto level = estimator.window().parameter(BlockKind::HeightBias);
  if (level) errors.level = *estimator.window().block(*level) - T_true_est->translation().z();
  const auto scale = estimator.window().parameter(BlockKind::VelocityScale);
  if (scale) errors.scale = *estimator.window().block(*scale);
  errors.observed_share = blind == 0 ? 0.0 : static_cast<double>(observed) / blind;
  std::printf("position %.3f m, height %.3f m, level %.3f m, scale %+.3f\n", errors.position, errors.height,
              errors.level, errors.scale);
  return errors;
}

TEST(ExternalFactors, HoldThePositionBeforeABlankWallByVelocity) {
  const Errors without = fly({}), with = fly({.velocity = true});
  EXPECT_LT(with.position, 0.25);
  EXPECT_LT(with.position, 0.4 * without.position);
  EXPECT_TRUE(with.plausible);
  EXPECT_EQ(without.observed_share, 0.0);
  EXPECT_GT(with.observed_share, 0.95);
}

TEST(ExternalFactors, HoldTheHeightBeforeABlankWallByHeightAlone) {
  const Errors without = fly({.blind_to = 20.0, .end = 20.0}),
               with = fly({.height = true, .blind_to = 20.0, .end = 20.0});
  EXPECT_LT(with.height, 0.15);
  EXPECT_LT(with.height, 0.5 * without.height);
}

TEST(ExternalFactors, HoldPositionAndHeightByBoth) {
  const Errors both = fly({.height = true, .velocity = true});
  EXPECT_LT(both.position, 0.25);
  EXPECT_LT(both.height, 0.1);
}

TEST(ExternalFactors, FindTheLevelOfAHeightSensor) {
  const Errors errors = fly({.height = true, .blind_to = 5.0, .level = -123.4});
  EXPECT_NEAR(errors.level, -123.4, 0.1);
  EXPECT_LT(errors.height, 0.1);
}

TEST(ExternalFactors, FindANewLevelAfterAStep) {
  const Errors errors = fly({.height = true, .blind_to = 5.0, .level = 2.0, .step = -3.0, .step_at = 7.0});
  EXPECT_NEAR(errors.level, -1.0, 0.15);
  EXPECT_LT(errors.height, 0.1);
}

TEST(ExternalFactors, HardlyChangeAnEstimateThatSees) {
  const Errors without = fly({.blind_to = 5.0}), with = fly({.height = true, .velocity = true, .blind_to = 5.0});
  EXPECT_LT(with.position, without.position + 0.02);
}

TEST(ExternalFactors, LeaveOutliersOut) {
  const Errors errors = fly({.height = true, .velocity = true, .outliers = 0.05});
  EXPECT_LT(errors.position, 0.3);
  EXPECT_LT(errors.height, 0.15);
}

TEST(ExternalFactors, BridgeAGap) {
  const Errors errors = fly({.height = true, .velocity = true, .gap_from = 7.0, .gap_to = 9.0});
  EXPECT_LT(errors.position, 0.5);
  EXPECT_TRUE(errors.plausible);
}

TEST(ExternalFactors, OfAWrongScaleDoNotBreakAnEstimateThatSees) {
  const Errors without = fly({.blind_to = 5.0});
  for (const double scale : {0.5, 0.9, 1.1, 1.5}) {
    const Errors errors = fly({.velocity = true, .blind_to = 5.0, .scale = scale});
    EXPECT_TRUE(errors.plausible) << scale;
    EXPECT_LT(errors.position, without.position + 0.15) << scale;
  }
}

TEST(ExternalFactors, FindTheScaleOfAVelocitySensorAndTakeItIntoTheDark) {
  const Errors exact = fly({.velocity = true, .blind_from = 9.0, .blind_to = 17.0, .end = 17.0});
  EXPECT_NEAR(exact.scale, 0.0, 0.02);
  const Errors wrong = fly({.velocity = true, .blind_from = 9.0, .blind_to = 17.0, .end = 17.0, .scale = 1.1});
  EXPECT_NEAR(wrong.scale, 0.1, 0.03);
  EXPECT_LT(wrong.position, exact.position + 0.15);
}

TEST(ExternalFactors, DoNoHarmInAHover) {
  const TestWorldOptions hover = {.rest_s = 1.0, .speed = 0.05, .turn = 0.1};
  constexpr int kFlights = 6;
  double without = 0.0, with = 0.0;  // mean of the errors
  for (int noise = 0; noise < kFlights; ++noise) {
    Flight flight = {.world = hover, .blind_to = 5.0, .end = 20.0, .noise = noise};
    without += fly(flight).position / kFlights;
    flight.height = flight.velocity = true;
    with += fly(flight).position / kFlights;
  }
  EXPECT_LT(with, without + 0.01);
}

TEST(ExternalFactors, StayInTheWindowWithOneFactorAStateAndSensor) {
  TestWorld world({.rest_s = 1.0});
  Estimator estimator(world.rig(), world.noise(), {});
  std::mt19937_64 random(5);
  for (int i = 1; i <= 200; ++i) {
    const double t = i * kPacket_s;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    input.external = samples_of({.height = true, .velocity = true}, world, t - kPacket_s, t, random);
    estimator.add(input);
  }
  std::map<StateId, int> heights, velocities;
  for (const auto& factor : estimator.window().factors()) {
    const StateId state = factor->blocks().front().id;
    if (dynamic_cast<const HeightFactor*>(factor.get()) != nullptr) ++heights[state];
    if (dynamic_cast<const VelocityFactor*>(factor.get()) != nullptr) ++velocities[state];
  }
  const std::size_t states = estimator.window().states().size();
  EXPECT_EQ(heights.size(), states - 1) << "all but the newest state";
  EXPECT_EQ(velocities.size(), states - 1);
  for (const auto& [state, count] : heights) EXPECT_EQ(count, 1) << state;
  for (const auto& [state, count] : velocities) EXPECT_EQ(count, 1) << state;
}

TEST(ExternalFactors, AreNotMadeWhereTheyAreSwitchedOff) {
  TestWorld world({.rest_s = 1.0});
  EstimatorConfig config;
  config.height.enabled = config.velocity.enabled = false;
  Estimator estimator(world.rig(), world.noise(), config), without(world.rig(), world.noise(), {});
  std::mt19937_64 random(5);
  for (int i = 1; i <= 60; ++i) {
    const double t = i * kPacket_s;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    without.add(input);
    TestWorld sensors({.rest_s = 1.0});
    input.external = samples_of({.height = true, .velocity = true}, sensors, t - kPacket_s, t, random);
    EXPECT_FALSE(estimator.add(input).velocity_observed);
  }
  EXPECT_EQ(estimator.window().estimates(), without.window().estimates());
}

TEST(VelocityConfig, TellsWhereTheSensorIs) {
  const VelocityConfig config{.position_m = "0.1, 0 -0.05", .rotation_deg = "0 0 90"};
  const SE3 T_B_S = config.T_B_S();
  EXPECT_EQ(T_B_S.translation(), Eigen::Vector3d(0.1, 0.0, -0.05));
  EXPECT_LT((T_B_S.R().col(0) - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  for (const char* text : {"", "1 2", "1 2 3 4", "1 2 x", "1 2 nan"}) {
    EXPECT_THROW((VelocityConfig{.rotation_deg = text}).T_B_S(), InputError) << text;
  }
}

}  // namespace
}  // namespace edged
