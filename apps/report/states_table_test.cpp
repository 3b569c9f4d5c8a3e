// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/states_table.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

TEST(CovarianceSamples, AreThePosesWithAFreshCovarianceByStart) {
  CovarianceSamples gathered;
  Step step, lost;
  const auto add_at = [&](double t_s, Step& added) {
    added.t = timestamp_from_seconds(t_s);
    gathered.add(added);
  };
  step.status = TrackingStatus::Good, lost.status = TrackingStatus::Lost;
  add_at(1, step);
  step.covariance = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  add_at(2, step);
  add_at(3, step);
  step.covariance->position *= 2.0;
  add_at(4, step);
  add_at(5, lost);
  step.covariance->position *= 2.0;
  add_at(6, step);
  step.status = TrackingStatus::Degraded;
  add_at(7, step);
  step.relocalized = true;
  add_at(8, step);
  const std::vector<StateCovarianceSample>& claims = gathered.all();
  ASSERT_EQ(claims.size(), 5u);
  const std::vector<double> stamps{2, 4, 6, 7, 8};
  for (std::size_t i = 0; i < stamps.size(); ++i) EXPECT_EQ(claims[i].t, timestamp_from_seconds(stamps[i]));
  EXPECT_FALSE(claims[3].good);
  EXPECT_EQ(claims[0].reference, claims[1].reference);
  EXPECT_EQ(claims[1].reference, claims[2].reference) << "after a loss the covariance contains it";
  EXPECT_EQ(claims[2].reference, claims[3].reference);
  EXPECT_NE(claims[3].reference, claims[4].reference) << "the pose has jumped";
}

}  // namespace
}  // namespace edged
