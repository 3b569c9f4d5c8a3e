// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/calibration_pair.hpp"

#include <gtest/gtest.h>

#include "edged/core/angles.hpp"
#include "edged/estimator/factors/landmark_factor.hpp"

namespace edged {
namespace {

class RelativePosePrior : public testing::Test {
 protected:
  static SE3 pose(const SE3& T_B_C, const CalibrationBlock& calibration) {
    return camera_pose(SE3(), {}, T_B_C, calibration.data());
  }

  /// Rotation (in B) and baseline (in the first camera) off those given, in sigmas, without linearization.
  Vector6d exact() const {
    const SE3 one = pose(one_, of_one_), other = pose(other_, of_other_);
    const Eigen::Vector3d turn_one = one_.R() * so3::log(one_.rotation().conjugate() * one.rotation());
    const Eigen::Vector3d turn_other = other_.R() * so3::log(other_.rotation().conjugate() * other.rotation());
    const auto baseline = [](const SE3& from, const SE3& to) {
      return Eigen::Vector3d(from.R().transpose() * (to.translation() - from.translation()));
    };
    Vector6d r;
    r << (turn_other - turn_one) / (config_.relative_rotation_sigma_deg * kDegree),
        (baseline(one, other) - baseline(one_, other_)) / (config_.baseline_sigma_mm * 1e-3);
    return r;
  }

  LinearPrior prior() const { return relative_pose_prior({0, one_, of_one_}, {1, other_, of_other_}, config_); }

  SE3 one_{so3::exp({0.4, -0.3, 1.2}), {0.02, -0.05, 0.01}}, other_{so3::exp({0.5, -0.2, 1.1}), {0.03, 0.07, 0.02}};
  CalibrationBlock of_one_{}, of_other_{};
  CalibrationConfig config_;
};

TEST_F(RelativePosePrior, IsZeroAsGivenAndLinearAround) {
  EXPECT_EQ(prior().r.norm(), 0.0);
  const LinearPrior given = prior();
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 2 * kCalibrationSize; ++i) {
    double& value = i < kCalibrationSize ? of_one_[i] : of_other_[i - kCalibrationSize];
    value = kStep;
    const Vector6d up = exact();
    value = -kStep;
    const Vector6d derivative = (up - exact()) / (2.0 * kStep);
    value = 0.0;
    EXPECT_LT((derivative - given.J.col(i)).norm(), 1e-5 * (1.0 + derivative.norm())) << i;
  }
}

TEST_F(RelativePosePrior, HoldsAtTheCorrectionsOfNow) {
  of_one_ = {0.004, -0.003, 0.002, 0.0, 0.002, -0.001, 0.003};
  of_other_ = {-0.002, 0.001, 0.003, 0.0, -0.001, 0.002, 0.001};
  EXPECT_LT((prior().r - exact()).norm(), 0.02 * exact().norm()) << "of second order";
}

TEST_F(RelativePosePrior, LetsTheRigTurnAsOne) {
  const Eigen::Vector3d turn_B(0.002, -0.003, 0.001);
  const auto turned = [&](const SE3& T_B_C) {
    CalibrationBlock block{};
    Eigen::Map<Eigen::Vector3d>(block.data()) = T_B_C.R().transpose() * turn_B;
    Eigen::Map<Eigen::Vector3d>(block.data() + kLeverArmAt) = turn_B.cross(T_B_C.translation());
    return block;
  };
  of_one_ = turned(one_);
  of_other_ = turned(other_);
  EXPECT_LT(prior().r.norm(), 1e-2);
}

}  // namespace
}  // namespace edged
