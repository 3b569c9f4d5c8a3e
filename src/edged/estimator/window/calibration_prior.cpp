// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/calibration_prior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

constexpr auto kCoefficients = static_cast<std::size_t>(kCorrectedCoefficients);

double second_coefficient_sigma(double first, const CameraModel& model) {
  if (corrected_coefficients(model) < kCorrectedCoefficients) return 0.0;
  const Eigen::Vector2d rim = model.pixel_to_point({0.0, model.cy()});
  const ByCoefficients by = lens_model(model.distortion()).by_coefficients(model.coefficients(), rim);
  const double second = by.col(1).norm();  // zero at the axis
  return second > 0.0 ? first * by.col(0).norm() / second : 0.0;
}

/// residual = J (corrections of one, corrections of other), r at the present ones.
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

CalibrationVector calibration_sigmas(const CalibrationConfig& config, const CameraModel& given) {
  CalibrationVector sigmas;
  sigmas.head<3>().setConstant(config.rotation_sigma_deg * kDegree);
  sigmas[kTimeAt] = config.time_offset_sigma_ms * 1e-3;
  sigmas.segment<3>(kLeverArmAt).setConstant(config.lever_arm_sigma_mm * 1e-3);
  const double centre = config.principal_point_sigma_px, first = config.distortion_sigma;
  sigmas.tail<kIntrinsics>() << config.focal_sigma, config.focal_sigma, centre / given.fx(), centre / given.fy(), first,
      second_coefficient_sigma(first, given);
  return sigmas;
}

CalibrationVector correction_between(const RigCamera& given, const RigCamera& found) {
  const CameraModel &before = given.model, &now = found.model;
  CalibrationVector x;
  x.head<3>() = so3::log(given.T_B_C.rotation().conjugate() * found.T_B_C.rotation());
  x[kTimeAt] = to_seconds(found.time_offset - given.time_offset);
  x.segment<3>(kLeverArmAt) = found.T_B_C.translation() - given.T_B_C.translation();
  x.segment<4>(kIntrinsicsAt) << std::log(now.fx() / before.fx()), std::log(now.fy() / before.fy()),
      (now.cx() - before.cx()) / before.fx(), (now.cy() - before.cy()) / before.fy();
  for (std::size_t i = 0; i < kCoefficients; ++i)
    x[kIntrinsicsAt + kCoefficientsAt + static_cast<int>(i)] = now.coefficients()[i] - before.coefficients()[i];
  return x;
}

RigCamera corrected_camera(const RigCamera& given, const CalibrationVector& correction) {
  RigCamera found = given;
  found.T_B_C = SE3(given.T_B_C.rotation() * so3::exp(Eigen::Vector3d(correction.head<3>())),
                    given.T_B_C.translation() + correction.segment<3>(kLeverArmAt));
  found.time_offset += duration_from_seconds(correction[kTimeAt]);
  found.model = corrected_model(given.model, correction.tail<kIntrinsics>()).value_or(given.model);
  return found;
}

LinearPrior equal_calibrations(const CameraInPair& one, const CameraInPair& other) {
  CalibrationVector weights = CalibrationVector::Constant(1.0 / kFactorTuning.equal_calibration_sigma);
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

CorrectionEstimate combined(std::span<const CorrectionEstimate> estimates, const CalibrationVector& prior_sigmas) {
  constexpr double kHeld = 1e-4;  // share of the prior's sigma: no recording determines so much
  EDGED_CHECK(!estimates.empty(), "no estimate");
  CorrectionEstimate all = estimates.front();
  std::vector<int> free;
  for (int i = 0; i < kCalibrationSize; ++i)
    if (std::ranges::all_of(estimates, [&](const CorrectionEstimate& one) {
          return one.covariance(i, i) > std::pow(kHeld * prior_sigmas[i], 2);
        }))
      free.push_back(i);
  // In units of the prior's sigmas.
  const Eigen::VectorXd unit = prior_sigmas(free);
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(size, size) * (1.0 - static_cast<double>(estimates.size()));
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(size);
  for (const CorrectionEstimate& one : estimates) {
    const Eigen::MatrixXd P =
        unit.cwiseInverse().asDiagonal() * one.covariance(free, free) * unit.cwiseInverse().asDiagonal();
    const Eigen::LLT<Eigen::MatrixXd> llt(P);
    information += llt.solve(Eigen::MatrixXd::Identity(size, size));
    weighted += llt.solve(one.correction(free).cwiseQuotient(unit));
  }
  const Eigen::MatrixXd P = information.inverse();
  all.correction(free) = unit.cwiseProduct(P * weighted);
  all.covariance.setZero();
  all.covariance(free, free) = unit.asDiagonal() * P * unit.asDiagonal();
  return all;
}

}  // namespace edged
