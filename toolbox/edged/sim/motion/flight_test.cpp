// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/motion/flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "edged/sim/motion/motion.hpp"
#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/test_recording.hpp"

namespace edged {
namespace {

ContinuousTrajectory flight(const std::string& preset, int seed = 1) {
  const SimulatorConfig config = simulator_preset(preset);
  return make_motion(config.motion, config.duration_s, config.T_B_C, static_cast<std::uint64_t>(seed));
}

Eigen::Vector3d position(const ContinuousTrajectory& trajectory, double t) {
  return trajectory.at(t).T_W_B.translation();
}

double heading(const Kinematics& k) {
  const Eigen::Vector3d x = k.T_W_B.rotation() * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

/// Begin and end of the manoeuvre.
struct Span {
  double begin, end;
};
Span manoeuvre(const std::string& preset) {
  const MotionConfig motion = simulator_preset(preset).motion;
  const double on_the_ground_s = 1.0, landed_s = to_seconds(fly(motion.flight, 1).back().t) - on_the_ground_s;
  return {motion.rest_s + 3.0, motion.rest_s + landed_s - 3.5};
}

class Flight : public testing::TestWithParam<std::string> {};

TEST_P(Flight, StartsAndEndsAtRestOnTheGround) {
  const SimulatorConfig config = simulator_preset(GetParam());
  const ContinuousTrajectory trajectory = flight(GetParam());
  for (double t = 0.0; t < 2.5; t += 0.1) {
    const Kinematics k = trajectory.at(t);
    EXPECT_EQ(k.v_W.norm() + k.a_W.norm() + k.omega_B.norm(), 0.0) << t;
  }
  for (const double t : {config.duration_s - 0.5, config.duration_s}) {
    const Kinematics k = trajectory.at(t);
    EXPECT_LT(k.v_W.norm(), 1e-4);
    EXPECT_LT(k.omega_B.norm(), 1e-4);
    EXPECT_NEAR(k.T_W_B.translation().z(), 0.25, 1e-3);
    EXPECT_GT((k.T_W_B.rotation() * Eigen::Vector3d::UnitZ()).z(), 0.9999);
  }
}

TEST_P(Flight, StaysInsideTheHallAtTheSpeedsOfADrone) {
  const SimulatorConfig config = simulator_preset(GetParam());
  for (const int seed : {1, 2}) {
    const ContinuousTrajectory trajectory = flight(GetParam(), seed);
    double fastest = 0.0, hardest = 0.0;
    for (double t = 0.0; t < config.duration_s; t += 0.02) {
      const Kinematics k = trajectory.at(t);
      const Eigen::Vector3d p = k.T_W_B.translation();
      EXPECT_LT(std::max(std::abs(p.x()), std::abs(p.y())), 2.2) << t;
      EXPECT_GT(p.z(), 0.24) << t;
      EXPECT_LT(p.z(), 1.8) << t;
      fastest = std::max(fastest, k.v_W.norm());
      hardest = std::max(hardest, k.a_W.norm());
    }
    EXPECT_GT(fastest, 1.0);
    EXPECT_LT(fastest, 3.5);
    EXPECT_LT(hardest, 10.0);
  }
  EXPECT_GT(config.duration_s, 25.0);
  EXPECT_LT(config.duration_s, 40.0);
}

TEST_P(Flight, CarriesItsWeightAlongItsOwnAxis) {
  const Span span = manoeuvre(GetParam());
  const ContinuousTrajectory trajectory = flight(GetParam());
  for (double t = span.begin; t < span.end; t += 0.1) {
    const Kinematics k = trajectory.at(t);
    const Eigen::Vector3d force_B = k.T_W_B.rotation().conjugate() * (k.a_W - kGravity_W);
    EXPECT_LT(force_B.head<2>().norm(), 1.5) << t;  // drag, and wobble of at most 2 degrees
  }
}

std::string name_of(const testing::TestParamInfo<std::string>& tested) {
  std::string name = tested.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(, Flight, testing::ValuesIn(kPaperFlights), name_of);

TEST(CircleFlight, ClosesAfterThreeLapsWithItsNoseAlongThePath) {
  const Span span = manoeuvre("circle");
  const ContinuousTrajectory trajectory = flight("circle");
  EXPECT_LT((position(trajectory, span.end) - position(trajectory, span.begin)).norm(), 0.1);
  double turned = 0.0, last = heading(trajectory.at(span.begin));
  for (double t = span.begin; t <= span.end; t += 0.02) {
    const Kinematics k = trajectory.at(t);
    EXPECT_NEAR(k.T_W_B.translation().head<2>().norm(), 1.6, 0.06);
    turned += std::remainder(heading(k) - last, 2.0 * M_PI);
    last = heading(k);
    if (k.v_W.norm() > 1.0) {
      EXPECT_NEAR(std::remainder(heading(k) - std::atan2(k.v_W.y(), k.v_W.x()), 2.0 * M_PI), 0.0, 0.15);
    }
  }
  EXPECT_NEAR(turned, 6.0 * M_PI, 0.1);
}

TEST(SquareFlight, StopsAtFourCornersAndKeepsToTheSides) {
  const Span span = manoeuvre("square");
  const ContinuousTrajectory trajectory = flight("square");
  std::vector<Eigen::Vector2d> stops;
  bool resting = false;
  for (double t = span.begin + 0.5; t < span.end - 0.5; t += 0.02) {
    const Kinematics k = trajectory.at(t);
    const Eigen::Vector2d p = k.T_W_B.translation().head<2>();
    EXPECT_NEAR(p.cwiseAbs().maxCoeff(), 1.4, 0.04) << t;
    const bool slow = k.v_W.norm() < 0.15;
    if (slow && !resting) stops.push_back(p);
    resting = slow;
  }
  ASSERT_GE(stops.size(), 7U);
  for (const Eigen::Vector2d& stop : stops) EXPECT_NEAR(stop.cwiseAbs().minCoeff(), 1.4, 0.06);
}

TEST(LineFlight, GoesToAndFroOnALine) {
  const Span span = manoeuvre("line");
  const ContinuousTrajectory trajectory = flight("line");
  double low = 1e9, high = -1e9;
  for (double t = span.begin; t < span.end; t += 0.02) {
    const Eigen::Vector3d p = position(trajectory, t);
    EXPECT_NEAR(p.y(), 0.0, 0.04);
    low = std::min(low, p.x()), high = std::max(high, p.x());
  }
  EXPECT_NEAR(high - low, 3.8, 0.1);
}

TEST(TurnedFlight, YawsByMoreThanHalfATurnAndFast) {
  const Span span = manoeuvre("turned");
  const ContinuousTrajectory trajectory = flight("turned");
  double yaw = 0.0, last = heading(trajectory.at(span.begin)), low = 0.0, high = 0.0, fastest = 0.0;
  for (double t = span.begin; t < span.end; t += 0.01) {
    const Kinematics k = trajectory.at(t);
    yaw += std::remainder(heading(k) - last, 2.0 * M_PI);
    last = heading(k);
    low = std::min(low, yaw), high = std::max(high, yaw);
    fastest = std::max(fastest, k.omega_B.norm());
  }
  EXPECT_GT(high - low, M_PI);
  EXPECT_GT(fastest, 2.5);
}

TEST(AggressiveFlight, RollsAndShiftsToTheSides) {
  const Span span = manoeuvre("aggressive");
  const ContinuousTrajectory trajectory = flight("aggressive");
  double roll = 0.0, speed = 0.0;
  for (double t = span.begin; t < span.end; t += 0.01) {
    const Kinematics k = trajectory.at(t);
    roll = std::max(roll, std::abs((k.T_W_B.rotation() * Eigen::Vector3d::UnitY()).z()));
    speed = std::max(speed, std::abs(k.v_W.y()));
  }
  EXPECT_GT(std::asin(roll), 25.0 * M_PI / 180.0);
  EXPECT_GT(speed, 2.5);
}

}  // namespace
}  // namespace edged
