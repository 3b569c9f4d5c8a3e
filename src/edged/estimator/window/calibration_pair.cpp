// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/calibration_pair.hpp"

#include <utility>

#include "edged/core/angles.hpp"

namespace edged {
namespace {

/// residual = J (corrections of one, corrections of other), r at those of now.
LinearPrior prior_of_pair(const CameraInPair& one, const CameraInPair& other, Eigen::MatrixXd J, Eigen::VectorXd r) {
  LinearPrior prior;
  prior.blocks = {{BlockKind::Calibration, one.index}, {BlockKind::Calibration, other.index}};
  prior.x0 = {{one.calibration.begin(), one.calibration.end()}, {other.calibration.begin(), other.calibration.end()}};
  prior.J = std::move(J);
  prior.r = std::move(r);
  return prior;
}

Eigen::Map<const CalibrationVector> corrections(const CameraInPair& camera) {
  return Eigen::Map<const CalibrationVector>(camera.calibration.data());
}

}  // namespace

LinearPrior equal_calibrations(const CameraInPair& one, const CameraInPair& other) {
  constexpr double kEqual = 1e-4;
  CalibrationVector weights = CalibrationVector::Constant(1.0 / kEqual);
  weights[kTimeAt] = 0.0;
  const Eigen::MatrixXd W = weights.asDiagonal();
  Eigen::MatrixXd J(kCalibrationSize, 2 * kCalibrationSize);
  J << W, -W;
  return prior_of_pair(one, other, std::move(J), weights.cwiseProduct(corrections(one) - corrections(other)));
}

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
  now << corrections(one), corrections(other);
  return prior_of_pair(one, other, J, J * now);
}

}  // namespace edged
