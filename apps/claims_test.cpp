// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "claims.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

TEST(Claims, AreThePosesWithAFreshCovarianceByStart) {
  Claims gathered;
  OdometryOutput output, lost;
  output.status = TrackingStatus::Good, lost.status = TrackingStatus::Lost;
  gathered.add(timestamp_from_seconds(1), output);
  output.covariance = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  gathered.add(timestamp_from_seconds(2), output);
  gathered.add(timestamp_from_seconds(3), output);
  output.covariance->position *= 2.0;
  gathered.add(timestamp_from_seconds(4), output);
  gathered.add(timestamp_from_seconds(5), lost);
  gathered.add(timestamp_from_seconds(6), output);
  output.status = TrackingStatus::Degraded;
  gathered.add(timestamp_from_seconds(7), output);
  const std::vector<ClaimedPose>& claims = gathered.all();
  ASSERT_EQ(claims.size(), 4u);
  const std::vector<double> stamps{2, 4, 6, 7};
  for (std::size_t i = 0; i < stamps.size(); ++i) EXPECT_EQ(claims[i].t, timestamp_from_seconds(stamps[i]));
  EXPECT_FALSE(claims[3].good);
  EXPECT_EQ(claims[0].start, claims[1].start);
  EXPECT_NE(claims[1].start, claims[2].start);
}

}  // namespace
}  // namespace edged
