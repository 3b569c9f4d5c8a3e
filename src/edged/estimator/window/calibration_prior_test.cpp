// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/calibration_prior.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "edged/core/angles.hpp"
#include "edged/estimator/factors/landmark_factor.hpp"

namespace edged {
namespace {

RigCamera davis() {
  return {"frames", Modality::Frames,
          CameraModel(240, 180, 199.4, 199.7, 133.8, 114.0, DistortionModel::RadTan, {-0.38, 0.19, -1e-3, -6e-4, 0.0}),
          SE3(so3::exp({0.1, -0.2, 0.3}), {0.01, 0.02, 0.03}), Duration(2'000'000)};
}

CalibrationVector some_correction() {
  CalibrationVector x;
  x << 0.01, -0.02, 0.015, 3e-3, 4e-3, -5e-3, 6e-3, 0.008, -0.006, 0.005, -0.004, 0.012, -0.01;
  return x;
}

TEST(CalibrationPrior, ACorrectionIsFoundAgainBetweenTheCamerasThatItTellsApart) {
  const CalibrationVector x = some_correction();
  EXPECT_LT((correction_between(davis(), corrected_camera(davis(), x)) - x).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(CalibrationPrior, SecondCoefficientMovesTheRimAsFarAsTheFirst) {
  const CalibrationVector sigmas = calibration_sigmas({}, davis().model);
  const double r = davis().model.pixel_to_point({0.0, davis().model.cy()}).norm();
  EXPECT_NEAR(sigmas[calibration_at::kDistortion + 1] * r * r, sigmas[calibration_at::kDistortion], 1e-9);
  const CameraModel fov(240, 180, 199, 199, 120, 90, DistortionModel::FieldOfView, {0.9});
  EXPECT_EQ(calibration_sigmas({}, fov)[calibration_at::kDistortion + 1], 0.0) << "it has but one";
}

/// Two recordings, of which each shows one of two numbers; the prior's information is not counted twice.
TEST(CalibrationPrior, RecordingsAreCombinedByTheirInformation) {
  const CalibrationVector prior = CalibrationVector::Constant(0.1);
  std::vector<CorrectionEstimate> estimates(2);
  for (std::size_t i = 0; i < 2; ++i) {
    CalibrationVector variances = CalibrationVector::Constant(0.01);
    variances[static_cast<int>(i)] = 1e-6;
    variances[5] = 2e-4;
    variances[6] = 0.0;  // held
    estimates[i].covariance = variances.asDiagonal();
    estimates[i].correction.setZero();
    estimates[i].correction[static_cast<int>(i)] = 0.2;
    estimates[i].correction[5] = i == 0 ? 0.02 : 0.04;
  }
  const CorrectionEstimate all = combined(estimates, prior);
  EXPECT_NEAR(all.correction[0], 0.2, 1e-4);
  EXPECT_NEAR(all.correction[1], 0.2, 1e-4);
  EXPECT_NEAR(all.correction[5], 0.0303, 1e-4) << "each was pulled to zero by the prior, their mean is so but once";
  EXPECT_NEAR(all.covariance(2, 2), 0.01, 1e-9) << "of what no recording shows";
  EXPECT_NEAR(all.covariance(5, 5), 1.0 / (2.0 / 2e-4 - 1.0 / 0.01), 1e-9);
  EXPECT_EQ(all.covariance(6, 6), 0.0);
  EXPECT_TRUE(combined(std::vector{estimates[0]}, prior).correction.isApprox(estimates[0].correction));
}

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
