// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/estimated_calibration.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "edged/camera/lens_table.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/core/angles.hpp"
#include "edged/estimator/window/calibration_prior.hpp"

namespace edged {
namespace {

/// Calibrations are accurate to a degree: smaller rotations do not determine the direction. The inverse must be far
/// closer.
bool fits_inverse(const SE3& given, const SE3& found, double found_deg, double sigma_deg) {
  constexpr double kLeast_deg = 1.0, kSigmas = 4.0, kNearer = 0.4;
  const double inverse_deg = kDegreesPerRadian * so3::log(given.rotation() * found.rotation()).norm();
  return found_deg > std::max(kLeast_deg, kSigmas * sigma_deg) && inverse_deg < kNearer * found_deg;
}

}  // namespace

CalibrationCovariances calibration_covariances(const Odometry& odometry) {
  CalibrationCovariances covariances;
  for (const RigCamera& camera : odometry.rig().cameras)
    if (const auto P = odometry.calibration_covariance(camera.name)) covariances[camera.name] = *P;
  return covariances;
}

std::vector<CorrectionFound> corrections_of(const RigCamera& given, const RigCamera& found,
                                            const CalibrationCovariance& P, const CalibrationConfig& config) {
  using namespace calibration_at;
  const CalibrationVector off = correction_between(given, found), prior = calibration_sigmas(config, given.model);
  const double fx = given.model.fx(), fy = given.model.fy();
  struct Number {
    std::string name;
    Eigen::Index at;
    double unit;
  };
  std::vector<Number> numbers{{"x_mm", kLeverArm, 1e3},          {"y_mm", kLeverArm + 1, 1e3},
                              {"z_mm", kLeverArm + 2, 1e3},      {"fx_percent", kFocal, 100.0},
                              {"fy_percent", kFocal + 1, 100.0}, {"cx_px", kCentre, fx},
                              {"cy_px", kCentre + 1, fy}};
  const std::vector<std::string_view> coefficients = coefficient_names(lens_model(given.model.distortion()));
  for (int i = 0; i < corrected_coefficients(given.model); ++i)
    numbers.push_back({std::string(coefficients[static_cast<std::size_t>(i)]), kDistortion + i, 1.0});
  std::vector<CorrectionFound> out;
  for (const auto& [name, at, unit] : numbers)
    out.push_back({name, unit * off[at], unit * std::sqrt(P(at, at)), unit * prior[at]});
  return out;
}

std::vector<CalibrationFound> compare_calibrations(const Rig& given, const Rig& estimated,
                                                   const CalibrationCovariances& covariances,
                                                   const CalibrationConfig& config) {
  constexpr double kBeyond = 4.0;  // sigmas of the prior
  std::vector<CalibrationFound> out;
  for (const RigCamera& camera : estimated.cameras) {
    const RigCamera& before = given.camera(camera.name);
    const Eigen::Vector3d turned = so3::log((before.T_B_C.inverse() * camera.T_B_C).rotation());
    CalibrationFound found;
    found.camera = camera.name;
    found.rotation_deg = kDegreesPerRadian * turned.norm();
    found.time_offset_ms = 1e3 * to_seconds(camera.time_offset);
    found.given_offset_ms = 1e3 * to_seconds(before.time_offset);
    found.beyond = found.rotation_deg > kBeyond * config.rotation_sigma_deg ||
                   std::abs(found.time_offset_ms - found.given_offset_ms) > kBeyond * config.time_offset_sigma_ms;
    found.events = camera.modality == Modality::Events;
    if (const auto P = covariances.find(camera.name); P != covariances.end()) {
      const Eigen::Matrix3d rotation = P->second.block<3, 3>(calibration_at::kRotation, calibration_at::kRotation);
      // The variance of the estimated angle; if that is zero, of the least certain axis.
      const Eigen::Vector3d axis = turned.normalized();
      const double variance = turned.norm() > 0.0
                                  ? axis.dot(rotation * axis)
                                  : Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rotation).eigenvalues()[2];
      found.rotation_sigma_deg = kDegreesPerRadian * std::sqrt(variance);
      found.time_sigma_ms = 1e3 * std::sqrt(P->second(calibration_at::kTime, calibration_at::kTime));
      found.corrections = corrections_of(before, camera, P->second, config);
      found.inverse = fits_inverse(before.T_B_C, camera.T_B_C, found.rotation_deg, *found.rotation_sigma_deg);
    }
    out.push_back(found);
  }
  return out;
}

Calibration with_estimated(Calibration given, const Rig& estimated) {
  given.rig = with_estimated(given.rig, estimated);
  return given;
}

}  // namespace edged
