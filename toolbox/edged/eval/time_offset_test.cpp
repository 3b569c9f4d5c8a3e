// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/time_offset.hpp"

#include <gtest/gtest.h>

#include "edged/eval/test_trajectories.hpp"

namespace edged {
namespace {

TEST(TimeOffset, IsFoundAtAnyRateOfTheTruth) {
  const Trajectory estimate = winding_motion(20.0, 30.0);
  for (const double rate_hz : {100.0, 20.0, 2.0}) {
    Trajectory truth = winding_motion(22.0, rate_hz);
    for (StampedPose& pose : truth) pose.t += duration_from_seconds(0.05);  // late
    const TimeOffset found = fit_time_offset(truth, estimate);
    EXPECT_NEAR(found.offset_s, 0.05, 5e-4) << rate_hz;
    EXPECT_LT(found.ate_rmse_m, 1e-3) << rate_hz;
    EXPECT_GT(found.ate_given_m, 0.01) << rate_hz;
    EXPECT_TRUE(found.matters());
  }
}

TEST(TimeOffset, OfAPartIsAnErrorOfTheEstimate) {
  const Trajectory truth = winding_motion(22.0, 50.0);
  Trajectory estimate = winding_motion(20.0, 50.0);
  for (std::size_t i = 0; i < 2 * estimate.size() / 3; ++i) estimate[i].t -= duration_from_seconds(0.1);
  const TimeOffset found = fit_time_offset(truth, estimate);
  EXPECT_GT(found.offset_s, 0.02);
  EXPECT_FALSE(found.matters());
}

TEST(TimeOffset, IsFoundWhereAThirdHasNoGroundTruth) {
  const Trajectory estimate = winding_motion(20.0, 50.0);
  Trajectory truth = winding_motion(22.0, 50.0);
  const Timestamp begin = truth.front().t;
  std::erase_if(truth, [&](const StampedPose& pose) { return std::abs(to_seconds(pose.t - begin) - 10.0) < 4.0; });
  for (StampedPose& pose : truth) pose.t += duration_from_seconds(0.05);
  EXPECT_TRUE(fit_time_offset(truth, estimate).matters());
}

/// An estimate that is behind the truth by 8 ms and has errors of 2 mm beside that.
Trajectory late_and_wrong(const Trajectory& truth) {
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) {
    const double t = to_seconds(pose.t - truth.front().t);
    pose.T.translation() -= 0.008 * winding_velocity(pose.t) + Eigen::Vector3d(0, 0, 0.002 * std::sin(12.0 * t));
  }
  return estimate;
}

TEST(TimeOffset, OfFewSecondsMayBeChance) {
  const Trajectory seconds = winding_motion(4.0, 50.0), longer = winding_motion(12.0, 50.0);
  const TimeOffset of_seconds = fit_time_offset(seconds, late_and_wrong(seconds));
  EXPECT_NEAR(std::abs(of_seconds.offset_s), 0.008, 0.003);
  EXPECT_LT(of_seconds.ate_rmse_m, 0.7 * of_seconds.ate_given_m);
  EXPECT_FALSE(of_seconds.matters());
  EXPECT_TRUE(fit_time_offset(longer, late_and_wrong(longer)).matters());
}

TEST(TimeOffset, OfATruthOnTheSameClockDoesNotMatter) {
  const Trajectory motion = winding_motion(20.0, 50.0);
  EXPECT_NEAR(fit_time_offset(motion, motion).offset_s, 0.0, 1e-3);
  EXPECT_FALSE(fit_time_offset(motion, motion).matters());
  EXPECT_FALSE(fit_time_offset(motion, scaled(1.2, motion)).matters());  // another kind of error
  EXPECT_FALSE(fit_time_offset({}, motion).matters());
}

}  // namespace
}  // namespace edged
