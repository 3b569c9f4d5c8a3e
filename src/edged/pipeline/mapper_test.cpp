// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapper.hpp"

#include <gtest/gtest.h>

#include <string>

#include "edged/options.hpp"

namespace edged {
namespace {

/// Dead reckoning until a start at 12 s, after an estimate that ended at 11 s.
double dead_reckoning_of_a_restart(double lost_after_s) {
  OdometryConfig config;
  ConfigFields::of(config).set("status.lost_after_s", std::to_string(lost_after_s));
  SavedMap map;
  map.keyframes.push_back({timestamp_from_seconds(10), timestamp_from_seconds(10), "camera", {}, {}});
  map.T_M_K.emplace_back();
  map.covariance = 1e-4 * Eigen::MatrixXd::Identity(6, 6);
  Mapper mapper(config.map, config.status.lost_after_s);
  mapper.load(map);
  NavState now;
  now.t = timestamp_from_seconds(10.5);
  mapper.restart(SE3(), now);
  now.t = timestamp_from_seconds(11);
  mapper.predict(now);
  now.t = timestamp_from_seconds(12);
  mapper.restart(SE3(), now);
  return mapper.dead_reckoning_s();
}

TEST(Mapper, BoundsRelocalizationByTheTimeAfterWhichALossIsReported) {
  EXPECT_DOUBLE_EQ(dead_reckoning_of_a_restart(6.0) - dead_reckoning_of_a_restart(2.5), 3.5);
  EXPECT_GT(dead_reckoning_of_a_restart(2.5), 2.5);
}

}  // namespace
}  // namespace edged
