// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/relative_pose_prior.hpp"

#include "edged/core/angles.hpp"

namespace edged {

LinearPrior relative_pose_prior(const CameraInPair& one, const CameraInPair& other, const CalibrationConfig& config) {
  const Eigen::Matrix3d R_one = one.T_B_C.R(), R_other = other.T_B_C.R();
  const Eigen::Vector3d baseline = R_one.transpose() * (other.T_B_C.translation() - one.T_B_C.translation());
  Eigen::Matrix<double, 6, 2 * kCalibrationSize> J = Eigen::Matrix<double, 6, 2 * kCalibrationSize>::Zero();
  J.block<3, 3>(0, 0) = -R_one;
  J.block<3, 3>(0, kCalibrationSize) = R_other;
  J.block<3, 3>(3, 0) = skew(baseline);
  J.block<3, 3>(3, kLeverArmAt) = -R_one.transpose();
  J.block<3, 3>(3, kCalibrationSize + kLeverArmAt) = R_one.transpose();
  J.topRows<3>() /= config.relative_rotation_sigma_deg * kDegree;
  J.bottomRows<3>() /= config.baseline_sigma_mm * 1e-3;
  Eigen::Matrix<double, 2 * kCalibrationSize, 1> now;
  now << Eigen::Map<const CalibrationVector>(one.calibration.data()),
      Eigen::Map<const CalibrationVector>(other.calibration.data());
  LinearPrior prior;
  prior.blocks = {{BlockKind::Calibration, one.index}, {BlockKind::Calibration, other.index}};
  prior.x0 = {{one.calibration.begin(), one.calibration.end()}, {other.calibration.begin(), other.calibration.end()}};
  prior.J = J;
  prior.r = J * now;
  return prior;
}

}  // namespace edged
