// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/motion/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "edged/sim/motion/test_derivatives.hpp"

namespace edged {
namespace {

constexpr double kDuration_s = 12.0;
const Eigen::Vector3d kMiddle(0.0, 0.0, 1.3);

/// From the first moment on.
MotionConfig in_motion() {
  MotionConfig config;
  config.rest_s = config.blend_s = 0.0;
  return config;
}

ContinuousTrajectory motion_of(const MotionConfig& config) { return make_motion(config, kDuration_s, SE3(), 3); }

struct NamedMotion {
  const char* name;
  MotionConfig config;
};

std::vector<NamedMotion> new_motions() {
  std::vector<NamedMotion> motions;
  const auto add = [&motions](const char* name) -> MotionConfig& {
    return motions.emplace_back(NamedMotion{name, in_motion()}).config;
  };
  add("Approach").style = MotionStyle::Approach;
  add("Altitude").style = MotionStyle::Altitude;
  MotionConfig& pan = add("Pan");
  pan.style = MotionStyle::Pan, pan.lever_m = 0.05;
  add("StopAndGo").pause_s = 1.0;
  add("Tremor").tremor_mm = 0.5;
  MotionConfig& hover = add("Hover");
  hover.flight = Manoeuvre::Hover, hover.wind = 4.0;
  return motions;
}

class MotionKinds : public testing::TestWithParam<NamedMotion> {};

TEST_P(MotionKinds, HaveDerivativesThatAgreeWithDifferences) {
  const ContinuousTrajectory trajectory = motion_of(GetParam().config);
  for (double t = 0.501; t < kDuration_s - 0.5; t += 0.0737)
    expect_derivatives_at(t, trajectory, {.step_s = 1e-4, .a_W = 1e-3});
}

INSTANTIATE_TEST_SUITE_P(, MotionKinds, testing::ValuesIn(new_motions()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Motion, ApproachesAlongTheAxisAndChangesItsAltitudeAlongTheVertical) {
  for (const auto& [style, axis] : {std::pair(MotionStyle::Approach, 0), std::pair(MotionStyle::Altitude, 2)}) {
    MotionConfig config = in_motion();
    config.style = style;
    const ContinuousTrajectory trajectory = motion_of(config);
    Eigen::Vector3d reach = Eigen::Vector3d::Zero();
    for (double t = 0.0; t < kDuration_s; t += 0.05)
      reach = reach.cwiseMax((trajectory.at(t).T_W_B.translation() - kMiddle).cwiseAbs());
    EXPECT_GT(reach[axis], 0.5 * config.extent_m);
    reach[axis] = 0.0;
    EXPECT_LT(reach.maxCoeff(), 0.051 * config.extent_m);
  }
}

TEST(Motion, PansAboutAPointBehindTheCamera) {
  MotionConfig config = in_motion();
  config.style = MotionStyle::Pan;
  for (const double lever_m : {0.0, 0.05}) {
    config.lever_m = lever_m;
    const ContinuousTrajectory trajectory = motion_of(config);
    double turned = 0.0;
    for (double t = 0.0; t < kDuration_s; t += 0.05) {
      const SE3 T_W_C = trajectory.at(t).T_W_B;
      EXPECT_LT((T_W_C * Eigen::Vector3d(0.0, 0.0, -lever_m) - kMiddle).norm(), 1e-5) << t;
      turned = std::max(turned, so3::log(T_W_C.rotation().conjugate() * trajectory.at(0.0).T_W_B.rotation()).norm());
    }
    EXPECT_GT(turned, 0.3);
  }
}

TEST(Motion, StopsAgainAndAgainAndGoesOnAsFastAsBefore) {
  MotionConfig config = in_motion();
  config.go_s = 2.0, config.pause_s = 1.5;
  const ContinuousTrajectory trajectory = motion_of(config);
  double fastest = 0.0;
  for (double t = 0.0; t < kDuration_s; t += 0.01) {
    const Kinematics k = trajectory.at(t);
    const double into_s = std::fmod(t, 3.5);
    if (into_s > 2.5 && into_s < 3.4) {
      EXPECT_LT(k.v_W.norm() + k.omega_B.norm(), 1e-3) << t;
    }
    fastest = std::max(fastest, k.v_W.norm());
  }
  EXPECT_GT(fastest, 0.5 * config.max_speed);
  EXPECT_LT(fastest, 1.05 * config.max_speed);
}

TEST(Motion, OfAHandTremblesAsMuchAsItIsTold) {
  MotionConfig config = in_motion();
  const ContinuousTrajectory calm = motion_of(config);
  config.tremor_mm = 0.5;
  const ContinuousTrajectory hand = motion_of(config);
  Eigen::Array3d moved = Eigen::Array3d::Zero(), turned = Eigen::Array3d::Zero();
  int count = 0;
  for (double t = 0.5; t < kDuration_s - 0.5; t += 0.003, ++count) {
    const SE3 tremor = calm.at(t).T_W_B.inverse() * hand.at(t).T_W_B;
    moved += tremor.translation().array().square();
    turned += so3::log(tremor.rotation()).array().square();
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(1e3 * std::sqrt(moved[i] / count), 0.5, 0.1) << i;
    EXPECT_NEAR(1e3 * std::sqrt(turned[i] / count), 2.5, 0.5) << i;
  }
}

TEST(Motion, HoversAtOnePlaceAsCalmlyAsTheWindLetsIt) {
  constexpr double kInTheAir_s = 4.0;
  MotionConfig config = in_motion();
  config.flight = Manoeuvre::Hover;
  for (const double wind : {1.0, 4.0}) {
    config.wind = wind;
    const ContinuousTrajectory trajectory = motion_of(config);
    double drift = 0.0;
    for (double t = kInTheAir_s; t < kDuration_s; t += 0.05)
      drift = std::max(drift, (trajectory.at(t).T_W_B.translation() - kMiddle).cwiseAbs().maxCoeff());
    EXPECT_GT(drift, 0.015 * wind);
    EXPECT_LT(drift, 0.0251 * wind);
  }
}

}  // namespace
}  // namespace edged
