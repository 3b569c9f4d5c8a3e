// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A body in motion with its exact IMU: for factors that the IMU propagates to the time of a sample.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "edged/estimator/factors/test_jacobians.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {

/// A body that turns and accelerates, from the truth of its IMU.
class TestMotion {
 public:
  TestMotion() {
    for (int i = 0; i <= 100; ++i) {
      const double t = kStep_s * i;
      samples_.push_back({timestamp_from_seconds(t), {0.8 + t, -0.5, 0.3 * t}, {0.4, 9.6 - t, 1.5 + 2 * t}});
    }
    const OdomState start{
        samples_.front().t, SE3(so3::exp({0.3, -0.8, 0.2}), {1, 2, 3}), {0.4, -0.3, 0.2}, kBiasGyro, kBiasAccel};
    for (const auto& sample : samples_) {
      states_.push_back(sample.t == start.t ? start : propagate(start, between(0.0, to_seconds(sample.t))));
    }
  }

  /// IMU between two times, around the true biases.
  Preintegration between(double from_s, double to_s) const {
    const auto piece = slice_imu(samples_, timestamp_from_seconds(from_s), timestamp_from_seconds(to_s));
    return {piece, kBiasGyro, kBiasAccel, ImuNoise{}};
  }
  const OdomState& at(double t) const { return states_[static_cast<std::size_t>(std::lround(t / kStep_s))]; }

  /// Pose, motion and a scalar.
  Blocks blocks(double t, double scalar) const { return {pose_block(at(t).T_O_B), motion_numbers(at(t)), {scalar}}; }
  /// The blocks away from where the residual is zero.
  Blocks shifted(double t, double scalar) const {
    Blocks moved = blocks(t, scalar);
    moved[0][2] += 0.3;
    for (double& number : moved[1]) number += 0.02;
    return moved;
  }
  /// The measurement of a sensor at T_B_S.
  VelocitySample velocity(double t, const SE3& T_B_S, double sigma) const {
    const OdomState& state = at(t);
    const Eigen::Vector3d omega = samples_[static_cast<std::size_t>(std::lround(t / kStep_s))].gyro_B - state.bias_gyro;
    const Eigen::Vector3d v_B = state.T_O_B.R().transpose() * state.v_O + omega.cross(T_B_S.translation());
    return {state.t, T_B_S.R().transpose() * v_B, Eigen::Vector3d::Constant(sigma)};
  }

 private:
  static constexpr double kStep_s = 0.005;
  const Eigen::Vector3d kBiasGyro{0.01, -0.02, 0.03}, kBiasAccel{0.1, 0.05, -0.1};

  std::vector<ImuSample> samples_;
  std::vector<OdomState> states_;
};

/// A factor of state 1, whose IMU begins at 0.25 s, after that state is dropped: it moves to state 0 at 0.1 s.
inline std::shared_ptr<Factor> moved_to_state_before(const Factor& factor, const TestMotion& motion) {
  const Preintegration into = motion.between(0.1, 0.25), joined = motion.between(0.1, 0.5);
  return factor.without({0, 1, 2, joined, into});
}

/// Two samples with sigmas 0.1 and 0.2 merge into one with the mean of their residuals by weight. `both` equals `one`.
template <typename Kind>
void expect_merged_mean(const Kind& one, const Kind& other, Kind&& both, const Blocks& blocks) {
  ASSERT_TRUE(both.merge(other));
  const Eigen::VectorXd mean =
      (evaluate(one, blocks) / 0.1 + evaluate(other, blocks) / 0.2) / std::sqrt(1.0 / 0.01 + 1.0 / 0.04);
  EXPECT_LT((evaluate(both, blocks) - mean).norm(), 1e-9);
  check_jacobians(both, blocks);
}

}  // namespace edged
