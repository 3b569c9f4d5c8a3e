// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/imu_propagator.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

constexpr double kTurnRate = 0.8;  // [rad/s] about z

/// A body that moves straight and rotates about the vertical: samples every 5 ms.
std::vector<ImuSample> samples(double from_s, double to_s) {
  std::vector<ImuSample> imu;
  for (double t = from_s; t < to_s + 1e-6; t += 0.005) {
    imu.push_back({timestamp_from_seconds(t), {0, 0, kTurnRate}, {0, 0, 9.81}});
  }
  return imu;
}

OdomState moving(double t_s, double speed) {
  OdomState state;
  state.t = timestamp_from_seconds(t_s);
  state.v_O = {speed, 0, 0};
  return state;
}

TEST(ImuPropagator, BeforeTheStartTurnsInPlace) {
  ImuPropagator body({}, duration_from_seconds(0.1));
  body.predict(samples(0.0, 0.05), false);
  EXPECT_FALSE(body.started());
  EXPECT_EQ(body.now().T_O_B.translation(), Eigen::Vector3d::Zero());
  EXPECT_NEAR(so3::log(body.now().T_O_B.rotation()).z(), 0.05 * kTurnRate, 1e-9);
}

TEST(ImuPropagator, AfterItFollowsTheEstimateByTheImu) {
  ImuPropagator body({}, duration_from_seconds(0.1));
  body.predict(samples(0.0, 0.05), false);
  body.correct(moving(0.05, 2.0));
  const Preintegration motion = body.predict(samples(0.05, 0.1), true);
  EXPECT_TRUE(body.started());
  EXPECT_EQ(motion.begin(), timestamp_from_seconds(0.05));
  EXPECT_EQ(motion.end(), body.now().t);
  EXPECT_NEAR(body.now().T_O_B.translation().x(), 0.1, 1e-9);
  EXPECT_NEAR(body.extrapolate(duration_from_seconds(0.01)).translation().x(), 0.12, 1e-9);
  EXPECT_NEAR(so3::log(body.extrapolate(duration_from_seconds(0.01)).rotation()).z(), 0.06 * kTurnRate, 1e-9);
}

TEST(ImuPropagator, KeepsPosesOfItsHistoryWhichMoveWithTheEstimate) {
  ImuPropagator body({}, duration_from_seconds(0.1));
  for (int i = 0; i < 6; ++i) {
    body.predict(samples(0.05 * i, 0.05 * (i + 1)), i > 0);
    OdomState estimate = body.now();
    estimate.T_O_B = SE3(estimate.T_O_B.rotation(), estimate.T_O_B.translation() + Eigen::Vector3d(0, 1, 0));
    const double before = body.poses().front().T.translation().y();
    body.correct(estimate);
    EXPECT_NEAR(body.poses().front().T.translation().y(), before + 1.0, 1e-9);
  }
  EXPECT_GE(body.poses().front().t, timestamp_from_seconds(0.2));
  EXPECT_EQ(body.poses().back().t, body.now().t);
  for (std::size_t i = 1; i < body.poses().size(); ++i) EXPECT_LT(body.poses()[i - 1].t, body.poses()[i].t);
}

/// Where samples are missing: at the rate that the cameras have found, without acceleration.
TEST(ImuPropagator, GoesOnAsItDoesInAGapOfTheImu) {
  ImuPropagator body({}, duration_from_seconds(0.1));
  body.predict(samples(0.0, 0.05), false);
  body.correct(moving(0.05, 2.0));
  body.predict(samples(0.05, 0.1), true);
  const auto gap = [](double from_s, double to_s) {
    return std::vector<ImuSample>{{timestamp_from_seconds(from_s), {9, 9, 9}, {1, 1, 1}, true},
                                  {timestamp_from_seconds(to_s), {9, 9, 9}, {1, 1, 1}, true}};
  };
  body.predict(gap(0.1, 0.15), true);
  EXPECT_NEAR(so3::log(body.now().T_O_B.rotation()).z(), 0.1 * kTurnRate, 1e-9);
  EXPECT_NEAR(body.now().T_O_B.translation().x(), 0.2, 1e-9);
  OdomState estimate = body.now();  // in truth it has stopped to turn
  estimate.T_O_B = SE3(so3::exp({0, 0, 0.05 * kTurnRate}), estimate.T_O_B.translation());
  body.correct(estimate);
  body.predict(gap(0.15, 0.2), true);
  EXPECT_NEAR(so3::log(body.now().T_O_B.rotation()).z(), 0.05 * kTurnRate, 1e-9);
  EXPECT_NEAR(body.now().v_O.x(), 2.0, 1e-9);
  EXPECT_NEAR(body.silent_s(), 0.1, 1e-9);
}

/// The specific force of gravity turns with the body; between the ends of the gap it is no straight line.
TEST(ImuPropagator, KeepsTheVelocityInAGapWithinAPacketThatTheBodyTurnsIn) {
  const auto sample = [](double t) {
    const Eigen::Quaterniond R = so3::exp({2.0 * t, 0, 0});
    return ImuSample{timestamp_from_seconds(t), {2.0, 0, 0}, R.conjugate() * Eigen::Vector3d(0, 0, 9.81)};
  };
  std::vector<ImuSample> imu;
  for (int ms = 0; ms <= 1000; ms += 5)
    if (ms <= 100 || ms >= 900) imu.push_back(sample(1e-3 * ms));
  ImuPropagator body({}, duration_from_seconds(0.1));
  OdomState start = moving(0.0, 1.0);
  body.predict({sample(-0.01), sample(0.0)}, false);
  body.correct(start);
  const Preintegration motion = body.predict(imu, true);
  EXPECT_NEAR(motion.gap_s(), 0.8, 1e-4);
  EXPECT_NEAR(body.gap_s(), 0.8, 1e-4);
  EXPECT_NEAR((body.now().v_O - start.v_O).norm(), 0.0, 0.01);
  EXPECT_NEAR(body.now().T_O_B.translation().x(), 1.0, 0.01);
  EXPECT_NEAR(so3::log(body.now().T_O_B.rotation()).x(), 2.0, 1e-3);
  EXPECT_NEAR(std::sqrt(motion.covariance().diagonal().tail<3>().maxCoeff()), 1.6, 0.1) << "0.9 without the tilt";
}

}  // namespace
}  // namespace edged
