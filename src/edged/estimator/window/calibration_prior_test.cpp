// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/calibration_prior.hpp"

#include <gtest/gtest.h>

#include <vector>

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

}  // namespace
}  // namespace edged
