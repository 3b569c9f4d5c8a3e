// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Loops that the filter closes, most of whose keyframes are inactive.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "edged/map/map_filter.hpp"

namespace edged {
namespace {

/// A body that walks around a ring of 60 m, with an odometry whose yaw drifts by a constant rate, and its keyframes,
/// most of them inactive.
class Ring {
 public:
  static constexpr int kSteps = 60;
  static SE3 truth(int step) {
    const double a = 2.0 * M_PI * step / kSteps;
    return {so3::exp({0.0, 0.0, a}), {9.5 * std::sin(a), 9.5 * (1.0 - std::cos(a)), 0.0}};
  }

  Ring() : filter_(MapFilterConfig(), false, 10) {
    filter_.restart(SE3(), truth(0), Timestamp{}, 0.0, 0.0);
    const SE3 drift(so3::exp({0.0, 0.0, 0.001}), {0.001, 0.0, 0.0});
    for (int k = 0; k < kSteps; ++k) {
      if (k > 0) T_O_B_ = T_O_B_ * truth(k - 1).inverse() * truth(k) * drift;
      filter_.predict(SE3(), T_O_B_, timestamp_from_seconds(k), kDrift);
      filter_.add_keyframe(SE3(), T_O_B_, timestamp_from_seconds(k));
    }
    T_O_B_ = T_O_B_ * truth(kSteps - 1).inverse() * truth(kSteps);
    filter_.predict(SE3(), T_O_B_, timestamp_from_seconds(kSteps), kDrift);
    filter_.activate(std::array{0U});
  }
  static constexpr Drift kDrift = {0.005, 0.3 * kDegree, 0.06 * kDegree};
  double worst_error() const {
    double worst = 0.0;
    for (int k = 0; k < kSteps; ++k)
      worst = std::max(
          worst, (filter_.keyframes()[static_cast<std::size_t>(k)].translation() - truth(k).translation()).norm());
    return worst;
  }
  MapFilter& filter() { return filter_; }

  const Matrix6d covariance = 1e-4 * Matrix6d::Identity();

 private:
  MapFilter filter_;
  SE3 T_O_B_;
};

TEST(MapFilter, SpreadsTheCorrectionOfALoopOverItsKeyframes) {
  Ring ring;
  const double before = ring.worst_error();
  EXPECT_GT(before, 0.3);
  EXPECT_LT(ring.filter().squared_distance(0, SE3(), ring.covariance), 22.5) << "the drift is likely";
  const SE3 T_M_O = ring.filter().close(0, SE3(), ring.covariance);
  EXPECT_LT(ring.worst_error(), 0.2 * before);
  EXPECT_LT(ring.filter().T_M_B().translation().norm(), 0.02);
  EXPECT_GT(T_M_O.translation().norm(), 0.1);
  EXPECT_LT(ring.filter().covariance().trace(), 1e-2);
}

TEST(MapFilter, FindsALoopUnlikelyThatDriftDoesNotExplain) {
  Ring ring;
  const SE3 T_K_B(so3::exp({0.0, 0.0, 0.5}), {0.0, 4.0, 1.0});
  EXPECT_GT(ring.filter().squared_distance(0, T_K_B, ring.covariance), 50.0);
}

TEST(MapFilter, ClosesALoopByPositionWhereDriftIsLoosened) {
  // The drift of the ring, of which most is of yaw, does not explain 4 m.
  const SE3 T_K_B(SE3(so3::exp({0.0, 0.0, 0.02}), {-4.0, 0.0, 0.0}));
  std::vector<double> walk;
  for (int k = 0; k < Ring::kSteps; ++k) walk.push_back(4.0 * k / Ring::kSteps);
  Ring ring, loosened;
  loosened.filter().inflate(walk, 4.0);
  EXPECT_GT(ring.filter().squared_distance(0, T_K_B, ring.covariance), 22.5);
  EXPECT_LT(loosened.filter().squared_distance(0, T_K_B, ring.covariance), 22.5);
  loosened.filter().close(0, T_K_B, ring.covariance);
  EXPECT_LT((loosened.filter().T_M_B().translation() - T_K_B.translation()).norm(), 0.05);
  EXPECT_LT(so3::log(T_K_B.rotation().conjugate() * loosened.filter().T_M_B().rotation()).norm(), 0.02);
  const SE3& half_way = loosened.filter().keyframes()[Ring::kSteps / 2];
  EXPECT_NEAR(half_way.translation().x() - Ring().filter().keyframes()[Ring::kSteps / 2].translation().x(), -2.0, 0.7);
}

TEST(MapFilter, InflatesPositionsAndHeadingsButNoTilt) {
  MapFilter filter{MapFilterConfig()};
  filter.restart(SE3(), SE3(), Timestamp{}, 0.0, 0.0);
  filter.add_keyframe(SE3(), SE3(), Timestamp{});
  const SE3 rolled(so3::exp({0.5, 0.0, 0.0}), Eigen::Vector3d::Zero());
  filter.predict(SE3(), rolled, timestamp_from_seconds(1.0), {});
  filter.inflate(std::array{1e-4}, 4e-4, 0.25);
  Eigen::Matrix3d heading = Eigen::Matrix3d::Zero();
  heading(2, 2) = 1e-4;
  const Eigen::Matrix3d R = rolled.R();
  EXPECT_TRUE((filter.covariance().topLeftCorner<3, 3>()).isApprox(4e-4 * Eigen::Matrix3d::Identity(), 1e-9));
  EXPECT_TRUE((R * filter.covariance().bottomRightCorner<3, 3>() * R.transpose()).isApprox(heading, 1e-9));
  EXPECT_NEAR(filter.keyframe_covariance()(5, 5), 2.5e-5, 1e-12);
  EXPECT_NEAR(filter.keyframe_covariance()(4, 4), 0.0, 1e-12);
}

}  // namespace
}  // namespace edged
