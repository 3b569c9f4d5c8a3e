// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/state_prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace edged {
namespace {

constexpr double kRate = 1.5, kRadius = 2.0;  // [rad/s], [m]: a body on a circle, x outwards, z up
const Eigen::Vector3d kGyroBias(0.02, -0.01, 0.03), kAccelBias(0.1, 0.2, -0.1);

NavState true_state(double t_s) {
  const double angle = kRate * t_s;
  NavState state;
  state.t = timestamp_from_seconds(t_s);
  state.T_W_B = SE3(so3::exp({0, 0, angle}), kRadius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
  state.v_W = kRadius * kRate * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0);
  state.bias_gyro = kGyroBias;
  state.bias_accel = kAccelBias;
  return state;
}

ImuSample sample(double t_s) {
  return {timestamp_from_seconds(t_s), Eigen::Vector3d(0, 0, kRate) + kGyroBias,
          Eigen::Vector3d(-kRadius * kRate * kRate, 0, 9.81) + kAccelBias};
}

void expect_near(const std::optional<NavState>& state, double t_s) {
  ASSERT_TRUE(state) << t_s;
  const NavState truth = true_state(t_s);
  EXPECT_EQ(state->t, truth.t);
  EXPECT_LT((state->T_W_B.translation() - truth.T_W_B.translation()).norm(), 1e-4);
  EXPECT_LT(so3::log(truth.T_W_B.rotation().conjugate() * state->T_W_B.rotation()).norm(), 1e-6);
  EXPECT_LT((state->v_W - truth.v_W).norm(), 1e-4);
}

TEST(StatePrediction, FollowsACircleByTheImuAlone) {
  StatePrediction prediction;
  for (int i = 0; i <= 100; ++i) prediction.add(sample(0.005 * i));
  EXPECT_FALSE(prediction.newest()) << "nothing to predict from";
  prediction.correct(true_state(0.2525));  // between two samples
  expect_near(prediction.newest(), 0.5);
  for (int i = 101; i <= 110; ++i) prediction.add(sample(0.005 * i));
  expect_near(prediction.newest(), 0.55);
  for (const double t_s : {0.2525, 0.2537, 0.255, 0.4321, 0.55})
    expect_near(prediction.at(timestamp_from_seconds(t_s)), t_s);
  EXPECT_FALSE(prediction.at(timestamp_from_seconds(0.252)));
  EXPECT_FALSE(prediction.at(timestamp_from_seconds(0.551)));
}

TEST(StatePrediction, StartsAnewFromEveryEstimateAndEndsWithTheLast) {
  StatePrediction prediction;
  for (int i = 0; i <= 100; ++i) prediction.add(sample(0.005 * i));
  NavState wrong = true_state(0.25);
  wrong.v_W.x() += 1.0;
  prediction.correct(wrong);
  EXPECT_GT((prediction.newest()->v_W - true_state(0.5).v_W).norm(), 0.9);
  prediction.correct(true_state(0.3));
  expect_near(prediction.newest(), 0.5);
  prediction.correct(true_state(0.5));  // no later sample
  expect_near(prediction.newest(), 0.5);
  prediction.add(sample(0.505));
  expect_near(prediction.newest(), 0.505);
  prediction.correct(std::nullopt);
  EXPECT_FALSE(prediction.newest());
  EXPECT_FALSE(prediction.at(timestamp_from_seconds(0.5)));
}

TEST(StatePrediction, PassesOverSamplesThatAreNoneOrOutOfOrder) {
  StatePrediction prediction;
  for (int i = 0; i <= 100; ++i) {
    prediction.add(sample(0.005 * i));
    prediction.add(sample(0.005 * i - 0.001));
    ImuSample none = sample(0.005 * i + 0.001);
    none.gyro_B.x() = std::numeric_limits<double>::quiet_NaN();
    prediction.add(none);
  }
  prediction.correct(true_state(0.25));
  expect_near(prediction.newest(), 0.5);
}

TEST(StatePrediction, GoesOnAfterAStampFarAheadOrAClockThatWasSetBack) {
  StatePrediction prediction;
  for (const double jump_s : {3600.0, -100.0, 5.0}) {
    prediction.add(sample(jump_s));
    for (int i = 0; i <= 100; ++i) prediction.add(sample(0.005 * i));
    prediction.correct(true_state(0.25));
    expect_near(prediction.newest(), 0.5);
  }
}

TEST(StatePrediction, EndsASecondAfterTheEstimate) {
  StatePrediction prediction;
  prediction.add(sample(0));
  prediction.correct(true_state(0));
  for (int i = 1; i <= 200; ++i) prediction.add(sample(0.005 * i));
  expect_near(prediction.newest(), 1.0);
  prediction.add(sample(1.005));
  EXPECT_FALSE(prediction.newest());
}

TEST(StatePrediction, ForgetsAnEstimateThatIsOlderThanTheSamplesItKeeps) {
  StatePrediction prediction;
  prediction.add(sample(0));
  prediction.correct(true_state(0));
  for (int i = 1; i <= 50; ++i) prediction.add(sample(i));
  EXPECT_FALSE(prediction.newest());
  prediction.correct(true_state(1));
  EXPECT_FALSE(prediction.newest()) << "its samples are gone";
}

}  // namespace
}  // namespace edged
