// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "edged/core/check.hpp"
#include "edged/eval/test_trajectories.hpp"

namespace edged {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

TEST(Statistics, OfAFewNumbers) {
  const Statistics s = statistics({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4u);
  EXPECT_EQ(s.mean, 2.5);
  EXPECT_EQ(s.median, 2.5);
  EXPECT_EQ(s.min, 1.0);
  EXPECT_EQ(s.max, 4.0);
  EXPECT_EQ(s.sse, 30.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_EQ(statistics({5.0, 1.0, 3.0}).median, 3.0);
  EXPECT_EQ(statistics({}).count, 0u);
}

TEST(Evaluation, OfAMovedEstimateIsZeroUnderSE3) {
  const Trajectory estimate = winding_motion();
  const Evaluation result = evaluate(associate(moved(kTilted, estimate), estimate), protocol("P3"));
  EXPECT_LT(result.ate_m.max, 1e-12);
  EXPECT_LT(result.rotation_deg.max, 1e-6);
  EXPECT_LT(result.relative[0].translation_m.max, 1e-12);
  EXPECT_NEAR(result.duration_s, 20.0, 1e-12);
  EXPECT_NEAR(result.scale, 1.0, 1e-12);
}

TEST(Evaluation, PrintsTheScaleEvenWhereItIsNotApplied) {
  const Trajectory truth = winding_motion();
  const Association association = associate(truth, scaled(0.8, truth));
  EXPECT_NEAR(evaluate(association, protocol("P3")).scale, 1.25, 1e-12);
  EXPECT_GT(evaluate(association, protocol("P3")).ate_m.rmse, 0.1);
  EXPECT_LT(evaluate(association, protocol("P4")).ate_m.rmse, 1e-12);
}

TEST(Evaluation, OfAPathOfCentimetresHasNeitherScaleNorErrorsPerMetre) {
  const Trajectory tiny = scaled(1e-3, winding_motion());
  const Evaluation found = evaluate(associate(tiny, winding_motion()), protocol("P3"));
  EXPECT_LT(found.path_length_m, kShortestPath_m);
  EXPECT_TRUE(std::isnan(found.scale));
  EXPECT_TRUE(std::isnan(found.mpe_percent));
  EXPECT_GT(found.ate_m.rmse, 0.0);
}

TEST(Evaluation, TellsTheScaleOfTheStartApart) {
  // Too small by a fifth in the first 5 s, right from there on.
  const Trajectory truth = winding_motion();
  Trajectory estimate = truth;
  Eigen::Vector3d p = truth.front().T.translation();
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const bool start = to_seconds(truth[i].t - truth.front().t) <= 5.0;
    p += (start ? 0.8 : 1.0) * (truth[i].T.translation() - truth[i - 1].T.translation());
    estimate[i].T.translation() = p;
  }
  const Evaluation found = evaluate(associate(truth, estimate), protocol("P3"));
  EXPECT_NEAR(found.start_scale, 1.25, 1e-9);
  EXPECT_NEAR(found.first_scale, 1.25, 1e-9);
  EXPECT_NEAR(found.later_scale, 1.0, 1e-9);
  Trajectory resting = truth;
  for (StampedPose& pose : resting) {
    if (to_seconds(pose.t - truth.front().t) < 5.5) pose.T = truth.front().T;
  }
  EXPECT_TRUE(std::isnan(evaluate(associate(resting, truth), protocol("P3")).start_scale));
  EXPECT_TRUE(std::isnan(evaluate(associate(resting, truth), protocol("P3")).first_scale));
}

TEST(Evaluation, AlignsOnItsWindowOnly) {
  // Right until 110 s, then off by one metre: a window before the step must leave the step whole.
  const Trajectory truth = winding_motion();
  Trajectory estimate = moved(kTilted, truth);
  for (StampedPose& pose : estimate) {
    if (pose.t > timestamp_from_seconds(110.0)) pose.T.translation() += kTilted.rotation() * Eigen::Vector3d(0, 0, 1);
  }
  for (const char* name : {"P1", "P2"}) {
    const Evaluation result = evaluate(associate(truth, estimate), protocol(name));
    EXPECT_NEAR(result.ate_m.max, 1.0, 1e-10) << name;
    EXPECT_NEAR(result.ate_m.min, 0.0, 1e-10) << name;
    EXPECT_NEAR(result.ate_m.mean, 500.0 / 1001.0, 1e-10) << name;
    EXPECT_NEAR(result.mpe_percent, 100.0 * result.ate_m.mean / result.path_length_m, 1e-12) << name;
  }
  EXPECT_LT(evaluate(associate(truth, estimate), protocol("P3")).ate_m.rmse, 0.6);
}

TEST(Evaluation, MeasuresYawAndRotationPerMetre) {
  const Trajectory truth = winding_motion();
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) pose.T.rotation() = so3::exp({0, 0, 0.1}) * pose.T.rotation();
  const Evaluation result = evaluate(associate(truth, estimate), {"none", AlignmentKind::None, {}});
  EXPECT_NEAR(result.yaw_deg.mean, 0.1 * kDegrees, 1e-9);
  EXPECT_NEAR(result.rotation_deg.mean, 0.1 * kDegrees, 1e-9);
  EXPECT_NEAR(result.yaw_deg_per_m, 0.1 * kDegrees / result.path_length_m, 1e-9);
  EXPECT_EQ(result.ate_m.max, 0.0);
}

TEST(Evaluation, MeasuresTheTiltThatAlignmentHides) {
  const Trajectory truth = winding_motion();
  Trajectory estimate = truth;
  const SE3 tilted(so3::exp({0.02, 0, 0}), {0.5, 0, 0});
  for (StampedPose& pose : estimate) pose.T = tilted * pose.T;
  const Evaluation result = evaluate(associate(truth, estimate), protocol("P3"));
  EXPECT_NEAR(result.tilt_deg.mean, 0.02 * kDegrees, 1e-9);
  EXPECT_NEAR(result.tilt_deg.max, 0.02 * kDegrees, 1e-9);
  EXPECT_LT(result.ate_m.max, 1e-9);
}

TEST(RelativeError, OfASteadyDriftIsTheDriftPerDelta) {
  Trajectory truth, estimate;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.1 * i;
    truth.push_back({timestamp_from_seconds(t), SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(t, 0, 0))});
    estimate.push_back({timestamp_from_seconds(t), SE3(so3::exp({0, 0, 0.01 * t}), Eigen::Vector3d(1.1 * t, 0, 0))});
  }
  const RelativeError after_2_s = relative_error(associate(truth, estimate).pairs, 2.0);
  EXPECT_EQ(after_2_s.translation_m.count, 181u);
  EXPECT_NEAR(after_2_s.rotation_deg.mean, 0.02 * kDegrees, 1e-9);
  EXPECT_NEAR(after_2_s.translation_m.min, 0.2, 1e-9);  // at t = 0, before the yaw turns the step away
}

TEST(RelativeError, SkipsPairsThatAGapTearsApart) {
  Trajectory trajectory = winding_motion(10.0, 10.0);
  trajectory.erase(trajectory.begin() + 40, trajectory.begin() + 60);
  const Association association = associate(trajectory, trajectory, duration_from_seconds(5.0));
  EXPECT_LT(relative_error(association.pairs, 1.0).translation_m.count, 71u);
  EXPECT_LT(relative_error(association.pairs, 1.0).translation_m.max, 1e-12);
  EXPECT_EQ(relative_error(association.pairs, 50.0).translation_m.count, 0u);
}

TEST(LocalError, OfAMovedEstimateIsZeroInEveryWindow) {
  const Trajectory truth = winding_motion(20.0);
  const Evaluation result = evaluate(associate(truth, moved(kTilted, truth)), protocol("P3"));
  ASSERT_EQ(result.local.size(), 3U);
  // From 4 s on, a quarter of the window apart, as long as one ends before 20 s.
  EXPECT_EQ(result.local[0].windows, 60U);
  EXPECT_EQ(result.local[1].windows, 18U);
  EXPECT_EQ(result.local[2].windows, 3U);
  for (const LocalError& local : result.local) EXPECT_LT(local.rmse_m, 1e-12) << local.window_s;
}

TEST(LocalError, OfASteadyDriftAlongALineIsItsSpreadOverAWindow) {
  // Too fast by a hundredth: what is left of n steps of a window is uniform, of variance (n^2 - 1) / 12.
  Trajectory truth, estimate;
  for (int i = 0; i <= 2000; ++i) {
    const double t = 0.01 * i;
    truth.push_back({timestamp_from_seconds(t), SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(t, 0, 0))});
    estimate.push_back({timestamp_from_seconds(t), SE3(kTilted.rotation(), kTilted * Eigen::Vector3d(1.01 * t, 0, 0))});
  }
  const Association association = associate(truth, estimate);
  for (const double window_s : {1.0, 3.0, 10.0}) {
    const double n = 100.0 * window_s;
    EXPECT_NEAR(local_error(association, window_s).rmse_m, 1e-4 * std::sqrt((n * n - 1.0) / 12.0), 1e-12) << window_s;
  }
}

TEST(LocalError, OfASlowDriftIsSmallWhereTheATEIsNot) {
  const Trajectory truth = winding_motion(40.0);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) {
    const double t = to_seconds(pose.t - truth.front().t);
    pose.T = SE3(so3::exp({0, 0, 0.002 * t}), Eigen::Vector3d(0.01 * t, 0, 0)) * pose.T;
  }
  const Evaluation result = evaluate(associate(truth, estimate), protocol("P3"));
  // At most the drift in a window about its middle: its translation, and its rotation 7 m from the axis.
  for (const LocalError& local : result.local) {
    EXPECT_LT(local.rmse_m, 0.024 * local.window_s / std::sqrt(12.0)) << local.window_s;
    EXPECT_LT(local.rmse_m, 0.3 * result.ate_m.rmse) << local.window_s;
  }
  EXPECT_LT(2.0 * result.local[0].rmse_m, result.local[1].rmse_m);
  EXPECT_LT(2.0 * result.local[1].rmse_m, result.local[2].rmse_m);
}

TEST(LocalError, ForgivesAStepOutsideItsWindowsAndTheStart) {
  const Trajectory truth = winding_motion(20.0);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) {
    if (pose.t < timestamp_from_seconds(104.0)) pose.T.translation().x() += 0.5 * std::sin(8.0 * to_seconds(pose.t));
  }
  EXPECT_LT(local_error(associate(truth, estimate), 3.0).rmse_m, 1e-12);
  // The 4 s begin at the first pose of the estimate: a truth that starts earlier, or is cut to the run, changes
  // nothing.
  estimate.erase(estimate.begin(), estimate.begin() + 150);
  EXPECT_LT(local_error(associate(truth, estimate), 3.0).rmse_m, 1e-12);
  EXPECT_EQ(local_error(associate(truth, estimate), 3.0).windows, 14U);
  const Trajectory cut(truth.begin() + 120, truth.end());
  EXPECT_EQ(local_error(associate(cut, estimate), 3.0).windows, 14U);
}

TEST(LocalError, OfARestIsWhatTheEstimateMoves) {
  const Trajectory moving = winding_motion(20.0);
  Trajectory resting = moving;
  for (StampedPose& pose : resting) pose.T = moving.front().T;
  EXPECT_LT(local_error(associate(resting, resting), 1.0).rmse_m, 1e-12);
  EXPECT_GT(local_error(associate(resting, moving), 1.0).rmse_m, 0.1);
}

TEST(LocalError, OfWhatIsTooShortOrTooSparseIsNothing) {
  const Trajectory truth = winding_motion(7.5);
  const Evaluation result = evaluate(associate(truth, truth), protocol("P3"));
  EXPECT_GT(result.local[0].windows, 0U);
  EXPECT_EQ(result.local[2].windows, 0U);
  EXPECT_TRUE(std::isnan(result.local[2].rmse_m));
  const Trajectory sparse = winding_motion(20.0, 10.0);  // ten poses a second
  EXPECT_EQ(local_error(associate(sparse, sparse), 1.0).windows, 0U);
  EXPECT_GT(local_error(associate(sparse, sparse), 3.0).windows, 0U);
  EXPECT_EQ(local_error(Association{}, 1.0).windows, 0U);
}

TEST(Protocol, NamesAreThoseOfTheLiterature) {
  EXPECT_EQ(protocol("P1").window, (TimeWindow{3.0, 8.0}));
  EXPECT_EQ(protocol("P2").window, (TimeWindow{0.0, 5.0}));
  EXPECT_EQ(protocol("P4").alignment, AlignmentKind::Sim3);
  EXPECT_THROW(protocol("P5"), InputError);
}

TEST(Evaluation, OfTrajectoriesThatDoNotOverlapSaysSo) {
  const Trajectory truth = winding_motion();
  Trajectory later = truth;
  for (StampedPose& pose : later) pose.t += duration_from_seconds(1000.0);
  EXPECT_THROW(evaluate(associate(truth, later), protocol("P3")), InputError);
}

}  // namespace
}  // namespace edged
