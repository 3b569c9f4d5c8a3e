// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/initialization_solver.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

/// Frames of a body in motion, without the noise of pixels.
class StartOfAMotion : public testing::Test {
 protected:
  static constexpr double kBegin_s = 1.0, kFrame_s = 0.1;
  static constexpr int kFrames = 10;

  StartOfAMotion() {
    options_.pixel_noise = 0.1;
    options_.imu_noise = 0.1;
    options_.bias_accel = {0.02, -0.01, 0.015};
    TestWorld world(options_);
    for (int i = 0; i < kFrames; ++i) {
      const EstimatorInput input = world.packet(kBegin_s + kFrame_s * i, kFrame_s, true);
      frames_.push_back({input.t, input.motion.samples(), input.observations});
    }
    rig_ = world.rig();
    noise_ = world.noise();
    T_O_B0_ = world.T_W_B(kBegin_s);
    truth_ << T_O_B0_.R().transpose() * world.v_W(kBegin_s), T_O_B0_.R().transpose() * Eigen::Vector3d(0, 0, -kGravity),
        options_.bias_accel;
    last_.T_O_B = world.T_W_B(kBegin_s + kFrame_s * (kFrames - 1));
    last_.v_O = world.v_W(kBegin_s + kFrame_s * (kFrames - 1));
    last_.bias_accel = options_.bias_accel;
  }

  const StartPriors priors_{.biases = {.gyro_sigma = 0.02, .accel_sigma = 0.1}};
  InitializationSolver solver() const { return {frames_, rig_, options_.bias_gyro, noise_, priors_}; }
  static InitializationSolver::Chosen all(const InitializationSolver& solver) {
    InitializationSolver::Chosen chosen(solver.tracks().size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    return chosen;
  }

  TestWorldOptions options_;
  std::vector<InitFrame> frames_;
  Rig rig_;
  ImuNoise noise_;
  SE3 T_O_B0_;
  Start truth_;
  OdomState last_;
};

TEST_F(StartOfAMotion, GathersTracksOfThreeViewsOrMore) {
  const InitializationSolver start = solver();
  ASSERT_GT(start.tracks().size(), 30U);
  for (const StartTrack& track : start.tracks()) EXPECT_GE(track.observations.size(), 3U);
  ASSERT_EQ(start.motion().size(), frames_.size());
  EXPECT_NEAR(start.motion().back().t, kFrame_s * (kFrames - 1), 1e-9);
}

TEST_F(StartOfAMotion, LinearSolutionHasGravityAndVelocity) {
  const InitializationSolver start = solver();
  double free_length = 0.0;
  const std::optional<Start> x = start.linear(all(start), &free_length);
  ASSERT_TRUE(x);
  EXPECT_NEAR(x->segment<3>(3).norm(), kGravity, 1e-9);
  EXPECT_NEAR(free_length, kGravity, 0.1 * kGravity);
  EXPECT_LT((x->head<3>() - truth_.head<3>()).norm(), 0.2 * truth_.head<3>().norm());
  EXPECT_LT((x->segment<3>(3) - truth_.segment<3>(3)).norm(), 0.05 * kGravity);
}

TEST_F(StartOfAMotion, RefinementComesCloserAndKnowsHowClose) {
  const InitializationSolver start = solver();
  double free_length = 0.0;
  const std::optional<RefinedStart> refined = start.refine(all(start), *start.linear(all(start), &free_length), 10);
  ASSERT_TRUE(refined);
  EXPECT_NEAR(refined->x.segment<3>(3).norm(), kGravity, 1e-9);
  EXPECT_LT((refined->x.head<3>() - truth_.head<3>()).norm(), 0.1 * truth_.head<3>().norm());
  EXPECT_GT(start.relative_sigma(*refined), 0.0);
  EXPECT_LT(start.relative_sigma(*refined), 0.5);
  const std::vector<double> misfits = start.misfits(refined->x);
  ASSERT_EQ(misfits.size(), start.tracks().size());
  EXPECT_LT(std::accumulate(misfits.begin(), misfits.end(), 0.0) / static_cast<double>(misfits.size()), 1.0);
}

TEST_F(StartOfAMotion, FindsTheStartThatLeadsToAState) { EXPECT_LT((solver().start_of(last_) - truth_).norm(), 0.1); }

TEST_F(StartOfAMotion, TellsATrackThatMovesByItself) {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    FeatureObservation& feature = frames_[i].observations.front().features.front();
    feature.id = 5000;
    feature.point = {0.02 * static_cast<double>(i * i % 7), -0.01 * static_cast<double>(i % 3)};
  }
  const InitializationSolver start = solver();
  const auto wrong = std::ranges::find(start.tracks(), FeatureId{5000}, &StartTrack::id);
  ASSERT_NE(wrong, start.tracks().end());
  const auto place = static_cast<std::size_t>(wrong - start.tracks().begin());
  const std::vector<double> misfits = start.misfits(truth_);
  EXPECT_GT(misfits[place], 3.0);
  EXPECT_LT(misfits[0], 3.0);
}

TEST_F(StartOfAMotion, DirectionOfATrackPointsAtIt) {
  const InitializationSolver start = solver();
  TestWorld world(options_);
  const StartTrack& track = start.tracks().front();
  const std::size_t middle = track.observations[track.observations.size() / 2].frame;
  const double t = kBegin_s + kFrame_s * static_cast<double>(middle);
  const SE3 T_O_C = world.T_W_B(t) * rig_.cameras.front().T_B_C;
  const Eigen::Vector3d truth = T_O_B0_.R().transpose() * (world.point_W(track.id) - T_O_C.translation()).normalized();
  EXPECT_LT((start.direction(0) - truth).norm(), 0.02);
}

}  // namespace
}  // namespace edged
