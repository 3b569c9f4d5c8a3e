// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Known motions in a world with z up give the numbers of an autopilot; what it receives in every status.
#include "edged/autopilot/vehicle_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "edged/autopilot/autopilot_config.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;
using testing::FloatNear;
using testing::Pointwise;

constexpr double kQuarter = std::numbers::pi / 2.0;

/// Near these numbers, in order.
auto near(std::vector<float> expected) { return Pointwise(FloatNear(1e-5F), std::move(expected)); }

Step step_at(double t_s, TrackingStatus status = TrackingStatus::Good, std::size_t landmarks = 20) {
  Step step;
  step.t = timestamp_from_seconds(t_s);
  step.status = status;
  step.state.t = step.t;
  step.landmarks.resize(landmarks);
  step.covariance = StateCovariance{Vector3d(1.0, 4.0, 9.0).asDiagonal(), 1e-4 * Vector3d(1.0, 4.0, 9.0).asDiagonal(),
                                    Vector3d(0.01, 0.04, 0.09).asDiagonal()};
  return step;
}

class VehicleTrackerTest : public testing::Test {
 protected:
  /// The message at the state of a step that was noted.
  VehicleOdometry message(const Step& step, const Vector3d& gyro_B = Vector3d::Zero()) {
    tracker.note(step);
    return tracker.at(step.state, gyro_B).value();
  }
  int resets(const Step& step) { return message(step).reset_counter; }

  VehicleTracker tracker{AutopilotConfig{}.R_V_B()};
};

TEST_F(VehicleTrackerTest, AtRestAtTheOriginAllIsZeroInFrd) {
  const VehicleOdometry odometry = message(step_at(12.5));
  EXPECT_EQ(odometry.timestamp_sample, 12'500'000U);
  EXPECT_EQ(odometry.timestamp, 12'500'000U);
  EXPECT_EQ(odometry.pose_frame, 2);
  EXPECT_EQ(odometry.velocity_frame, 3);
  EXPECT_THAT(odometry.q, near({1, 0, 0, 0}));
  EXPECT_THAT(odometry.position, near({0, 0, 0}));
}

TEST_F(VehicleTrackerTest, ForwardLeftUpBecomesForwardRightDown) {
  Step step = step_at(1);
  step.state.T_W_B.translation() = {1.0, 2.0, 3.0};
  step.state.v_W = {0.1, 0.2, 0.3};
  step.state.bias_gyro = {0.01, 0.01, 0.01};
  const VehicleOdometry odometry = message(step, {0.41, 0.51, 0.61});
  EXPECT_THAT(odometry.position, near({1, -2, -3}));
  EXPECT_THAT(odometry.velocity, near({0.1F, -0.2F, -0.3F}));
  EXPECT_THAT(odometry.angular_velocity, near({0.4F, -0.5F, -0.6F}));
}

TEST_F(VehicleTrackerTest, ATurnToTheLeftIsANegativeYaw) {
  Step step = step_at(1);
  step.state.T_W_B.rotation() = so3::exp({0.0, 0.0, kQuarter});
  step.state.v_W = {0.0, 2.0, 0.5};  // forward and up
  const VehicleOdometry odometry = message(step);
  const float half = std::sqrt(0.5F);
  EXPECT_THAT(odometry.q, near({half, 0, 0, -half}));
  EXPECT_THAT(odometry.velocity, near({2, 0, -0.5F}));
}

TEST_F(VehicleTrackerTest, NoseUpIsAPositivePitch) {
  Step step = step_at(1);
  step.state.T_W_B.rotation() = so3::exp({0.0, -0.2, 0.0});  // with z up the nose goes up by a negative angle about y
  const VehicleOdometry odometry = message(step);
  EXPECT_THAT(odometry.q, near({std::cos(0.1F), 0, std::sin(0.1F), 0}));
}

TEST_F(VehicleTrackerTest, AnImuThatLooksForwardIsTurnedByTheMounting) {
  tracker = VehicleTracker(AutopilotConfig{.axes = "forward=z up=-y"}.R_V_B());
  Step step = step_at(1);
  Eigen::Matrix3d R_W_B;  // level, looking along x of W: the columns are the IMU's right, down and forward
  R_W_B << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  step.state.T_W_B = SE3(R_W_B, {1.0, 0.0, 0.0});
  step.state.v_W = {3.0, 0.0, 0.0};
  const VehicleOdometry odometry = message(step, {0.1, 0.2, 0.3});
  EXPECT_THAT(odometry.q, near({1, 0, 0, 0}));
  EXPECT_THAT(odometry.velocity, near({3, 0, 0}));
  EXPECT_THAT(odometry.angular_velocity, near({0.3F, 0.1F, 0.2F}));
  // About x, y, z of the IMU: right, down, forward.
  EXPECT_THAT(odometry.orientation_variance, near({9e-4F, 1e-4F, 4e-4F}));
}

TEST_F(VehicleTrackerTest, VariancesAreInWorldAndBody) {
  Step step = step_at(1);
  step.state.T_W_B.rotation() = so3::exp({0.0, 0.0, kQuarter});
  const VehicleOdometry odometry = message(step);
  EXPECT_THAT(odometry.position_variance, near({1, 4, 9}));
  EXPECT_THAT(odometry.orientation_variance, near({1e-4F, 4e-4F, 9e-4F}));
  EXPECT_THAT(odometry.velocity_variance, near({0.04F, 0.01F, 0.09F}));  // forward is y of W now
}

TEST_F(VehicleTrackerTest, VariancesGrowFromTheStepToTheState) {
  const Step step = step_at(1);
  const VehicleOdometry now = message(step);
  NavState later = step.state;
  later.t += std::chrono::milliseconds(500);
  const VehicleOdometry odometry = tracker.at(later, Vector3d::Zero()).value();
  // By the velocity, and by gravity along the tilt of hypot(0.01, 0.02) rad.
  const auto by_tilt = static_cast<float>(0.5 * 0.25 * 9.81 * std::hypot(0.01, 0.02));
  const auto square = [](float sigma) { return sigma * sigma; };
  EXPECT_THAT(odometry.position_variance,
              near({square(1.05F + by_tilt), square(2.1F + by_tilt), square(3.15F + by_tilt)}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(odometry.velocity_variance[i], now.velocity_variance[i]);
  EXPECT_EQ(odometry.orientation_variance, now.orientation_variance);
}

TEST_F(VehicleTrackerTest, AnUnknownCovarianceIsNan) {
  Step step = step_at(1);
  step.covariance.reset();
  const VehicleOdometry odometry = message(step);
  EXPECT_TRUE(std::isnan(odometry.position_variance[0]) && std::isnan(odometry.velocity_variance[2]) &&
              std::isnan(odometry.orientation_variance[1]));
}

TEST_F(VehicleTrackerTest, IsSilentBeforeTheStartAndWhileLost) {
  for (const TrackingStatus status : {TrackingStatus::Initializing, TrackingStatus::Lost}) {
    EXPECT_FALSE(tracker.at(step_at(1).state, Vector3d::Zero())) << to_string(status);
    message(step_at(1));
    tracker.note(step_at(2, status));
    EXPECT_FALSE(tracker.at(step_at(2).state, Vector3d::Zero())) << to_string(status);
  }
}

TEST_F(VehicleTrackerTest, QualityIsThatOfTheStatusAndTheLandmarks) {
  EXPECT_EQ(message(step_at(1, TrackingStatus::Good, 20)).quality, 70);
  EXPECT_EQ(message(step_at(2, TrackingStatus::Good, 500)).quality, 100);
  EXPECT_EQ(message(step_at(3, TrackingStatus::Good, 0)).quality, 51);
  EXPECT_EQ(message(step_at(4, TrackingStatus::Degraded, 500)).quality, 50);
  EXPECT_EQ(message(step_at(5, TrackingStatus::Degraded, 0)).quality, 1);
}

TEST_F(VehicleTrackerTest, CountsRestartsButNotTheFirstStart) {
  Step start = step_at(1);
  start.started = "at rest";
  EXPECT_EQ(resets(start), 0);
  EXPECT_EQ(resets(step_at(2)), 0);
  tracker.note(step_at(3, TrackingStatus::Lost));
  start.t = timestamp_from_seconds(4);
  EXPECT_EQ(resets(start), 1);
  EXPECT_EQ(resets(step_at(5)), 1);
}

TEST_F(VehicleTrackerTest, CountsARelocalizationOnce) {
  EXPECT_EQ(resets(step_at(1)), 0);
  Step step = step_at(2);
  step.relocalized = true;
  step.T_M_O.translation() = {5.0, 0.0, 0.0};
  EXPECT_EQ(resets(step), 1);
  step.relocalized = false;
  EXPECT_EQ(resets(step), 1);
}

TEST_F(VehicleTrackerTest, CountsCorrectionsOfTheMapThatMoveTheBodyFar) {
  Step step = step_at(1);
  step.state.T_W_B.translation() = {10.0, 0.0, 0.0};
  EXPECT_EQ(resets(step), 0);
  const auto correct = [&step](const SE3& correction) {
    step.T_M_O = correction * step.T_M_O;
    step.state.T_W_B = correction * step.state.T_W_B;
  };
  correct(SE3(Eigen::Quaterniond::Identity(), {0.0, 0.05, 0.0}));
  EXPECT_EQ(resets(step), 0);
  correct(SE3(Eigen::Quaterniond::Identity(), {0.0, 0.2, 0.0}));
  EXPECT_EQ(resets(step), 1);
  correct(SE3(so3::exp({0.0, 0.0, 0.02}), Vector3d::Zero()));  // moves the body by 0.2 m, as it is 10 m away
  EXPECT_EQ(resets(step), 2);
  const Vector3d p = step.state.T_W_B.translation();
  const Eigen::Quaterniond turn = so3::exp({0.0, 0.0, 0.1});
  correct(SE3(turn, p - turn * p));  // about the body itself
  EXPECT_EQ(resets(step), 3);
}

TEST_F(VehicleTrackerTest, TheResetCounterFollows255WithZero) {
  Step step = step_at(1);
  EXPECT_EQ(resets(step), 0);
  step.relocalized = true;
  for (int i = 1; i <= 255; ++i) EXPECT_EQ(resets(step), i);
  EXPECT_EQ(resets(step), 0);
}

}  // namespace
}  // namespace edged
