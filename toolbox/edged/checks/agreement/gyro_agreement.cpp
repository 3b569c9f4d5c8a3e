// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/gyro_agreement.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/checks/agreement/ray_fit.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestTurns = 30;
constexpr Duration kShiftStep = std::chrono::milliseconds(4);  // step of the search, which is then refined
constexpr Duration kFarthestShift = std::chrono::milliseconds(500);
constexpr double kUnlike = 0.5;  // of the rotation unexplained: above it the gyro does not belong to the camera

/// Rotations, each measured by the camera and by the gyro at one time shift [rad/s].
struct Pairs {
  std::vector<Eigen::Vector3d> camera, gyro;
  std::vector<Eigen::Vector3d> gyro_slope;  ///< d gyro / d shift [rad/s^2]
};

Pairs pairs_at(std::span<const Turn> turns, const GyroIntegral& integral, Duration shift) {
  constexpr Duration kStep = std::chrono::milliseconds(1);
  Pairs pairs;
  for (const Turn& turn : turns) {
    const auto phi = [&](Duration by) { return integral.between(turn.begin + by, turn.end + by); };
    const auto now = phi(shift), before = phi(shift - kStep), after = phi(shift + kStep);
    if (!now || !before || !after) continue;
    const double dt = to_seconds(turn.end - turn.begin);
    pairs.camera.push_back(turn.phi_C / dt);
    pairs.gyro.push_back(*now / dt);
    pairs.gyro_slope.push_back((*after - *before) / dt / (2 * to_seconds(kStep)));
  }
  return pairs;
}

/// Rotation and scale with gyro ~ scale * R * camera.
struct TurnFit {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double scale = 1.0;
  std::vector<double> weights;  ///< Cauchy
  double median_error = 0.0;    ///< [rad/s of the camera]
};

Eigen::Vector3d error_of(const Pairs& pairs, const TurnFit& fit, std::size_t i) {
  return pairs.gyro[i] / fit.scale - fit.R * pairs.camera[i];
}

/// Least squares with Cauchy weights (Arun et al. 1987; the scale by projection).
TurnFit fit_turns(const Pairs& pairs) {
  constexpr int kRounds = 6;
  const std::size_t n = pairs.camera.size();
  TurnFit fit;
  std::vector<double> errors(n), speeds(n);
  for (std::size_t i = 0; i < n; ++i) speeds[i] = pairs.camera[i].norm();
  const double usual = std::max(median(speeds), 1e-9);
  for (const double speed : speeds) fit.weights.push_back(std::min(1.0, std::pow(2 * usual / speed, 2)));
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    double camera = 0.0, both = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += fit.weights[i] * pairs.gyro[i] * pairs.camera[i].transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1.0 : 1.0;
    fit.R = svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    for (std::size_t i = 0; i < n; ++i) {
      both += fit.weights[i] * pairs.gyro[i].dot(fit.R * pairs.camera[i]);
      camera += fit.weights[i] * pairs.camera[i].squaredNorm();
    }
    fit.scale = std::max(both / std::max(camera, 1e-12), 1e-3);
    for (std::size_t i = 0; i < n; ++i) errors[i] = error_of(pairs, fit, i).norm();
    fit.median_error = median(errors);
    const double spread = std::max(fit.median_error, 1e-9);
    for (std::size_t i = 0; i < n; ++i) fit.weights[i] = 1.0 / (1.0 + std::pow(errors[i] / spread, 2));
  }
  return fit;
}

/// A Gauss-Newton step in the shift [s], with its uncertainty. Rotations overlap: `overlap` of them count as one.
double refine_shift(const Pairs& pairs, const TurnFit& fit, double overlap, GyroAgreement& agreement) {
  double slopes = 0.0, product = 0.0, squares = 0.0, weight = 0.0;
  Eigen::Matrix3d turning = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.camera.size(); ++i) {
    const double w = fit.weights[i];
    const Eigen::Vector3d error = error_of(pairs, fit, i), slope = pairs.gyro_slope[i] / fit.scale;
    slopes += w * slope.squaredNorm();
    product += w * slope.dot(error);
    squares += w * error.squaredNorm() / 3;
    weight += w;
    turning += w * pairs.camera[i] * pairs.camera[i].transpose();
  }
  const double variance = squares / weight * overlap;
  agreement.time_sigma_s = std::sqrt(variance / std::max(slopes, 1e-12));
  const Eigen::Matrix3d known =
      turning.trace() * Eigen::Matrix3d::Identity() - turning + 1e-12 * Eigen::Matrix3d::Identity();
  agreement.rotation_covariance = variance * known.inverse();
  return -product / std::max(slopes, 1e-12);
}

/// The number of rotations that contain the same instant.
double overlap_of(std::span<const Turn> turns) {
  double covered = 0.0;
  for (const Turn& turn : turns) covered += to_seconds(turn.end - turn.begin);
  return std::max(1.0, covered / std::max(to_seconds(turns.back().end - turns.front().begin), 1e-3));
}

/// The shift of the grid with the best fit of rotation and scale.
std::optional<Duration> best_shift(std::span<const Turn> turns, const GyroIntegral& gyro, Duration expected,
                                   Duration most) {
  std::optional<Duration> best;
  double least = std::numeric_limits<double>::infinity();
  for (Duration shift = expected - most; shift <= expected + most; shift += kShiftStep) {
    const Pairs pairs = pairs_at(turns, gyro, shift);
    if (pairs.camera.size() < kFewestTurns) continue;
    const double error = fit_turns(pairs).median_error;
    if (error < least) least = error, best = shift;
  }
  return best;
}

/// Errors of corners are correlated over seconds, so rotations are not independent: the uncertainty is estimated by
/// leaving out a tenth of the recording at a time (Efron and Tibshirani 1993, the jackknife by blocks).
Eigen::Matrix3d scatter_of(const Pairs& pairs, const Eigen::Matrix3d& R_B_C) {
  constexpr std::size_t kBlocks = 10;
  const std::size_t n = pairs.camera.size();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t block = 0; block < kBlocks; ++block) {
    Pairs kept;
    for (std::size_t i = 0; i < n; ++i) {
      if (i * kBlocks / n == block) continue;
      kept.camera.push_back(pairs.camera[i]);
      kept.gyro.push_back(pairs.gyro[i]);
    }
    const Eigen::Vector3d change = so3::log(Eigen::Quaterniond(R_B_C.transpose() * fit_turns(kept).R));
    sum += change * change.transpose();
  }
  return sum * (static_cast<double>(kBlocks) - 1) / static_cast<double>(kBlocks);
}

/// A refinement by the corners of the rotations, if given.
void use_rays(std::span<const Turn> turns, const GyroIntegral& gyro, Duration expected, GyroAgreement& agreement) {
  // With a wrong unit of the gyro a better rotation is useless.
  const double scale = agreement.gyro_scale;
  if (agreement.unexplained < kUnlike && (scale < 0.67 || scale > 1.5)) return;
  const auto fit = fit_rays(turns, gyro, {agreement.R_B_C, to_seconds(agreement.time_offset)}, to_seconds(expected));
  if (!fit) return;
  agreement.R_B_C = fit->mount.R_B_C;
  agreement.time_offset = duration_from_seconds(fit->mount.shift_s);
  agreement.gyro_scale = fit->mount.gyro_scale;
  agreement.scale_sigma = fit->scale_sigma;
  agreement.scale_unexplained = fit->scale_unexplained;
  agreement.accel = compare_with_accel(turns, gyro, fit->mount);
  agreement.unexplained = fit->unexplained;
  agreement.time_sigma_s = fit->shift_sigma_s;
  agreement.time_t = fit->shift_t;
  agreement.rotation_covariance = fit->rotation_covariance;
  agreement.rotation_sigma = std::sqrt(fit->rotation_covariance.selfadjointView<Eigen::Lower>().eigenvalues()[2]);
}

/// The systematic error of the rotation [rad]. Corners on images of events slide along edges, and blurred ones lag, in
/// all parts of a recording. This leaves rotation unexplained by the gyro, and gives a scale that no gyro has (correct
/// ones are within a per cent). Either may be an error of the rotation of the same size.
double common_error_of(const GyroAgreement& agreement) {
  constexpr double kOfUnexplained = 0.5;
  const double off_scale = agreement.scale_sigma > 0.0 ? std::log(std::max(agreement.gyro_scale, 1e-3)) : 0.0;
  return std::hypot(kOfUnexplained * std::min(agreement.unexplained, 1.0), off_scale);
}

/// compare_with_gyro for a gyro with correct signs, and time offsets up to `most` off.
std::optional<GyroAgreement> compare_as_given(std::span<const Turn> turns, const GyroIntegral& gyro, Duration expected,
                                              Duration most = kMostShift) {
  constexpr int kRefinements = 5;
  if (turns.size() < kFewestTurns) return std::nullopt;
  const auto coarse = best_shift(turns, gyro, expected, most);
  if (!coarse) return std::nullopt;
  GyroAgreement agreement;
  agreement.time_offset = *coarse;
  Pairs pairs;
  for (int i = 0; i < kRefinements; ++i) {
    pairs = pairs_at(turns, gyro, agreement.time_offset);
    if (pairs.camera.size() < kFewestTurns) return std::nullopt;
    const TurnFit fit = fit_turns(pairs);
    const double step_s = refine_shift(pairs, fit, overlap_of(turns), agreement);
    agreement.time_offset = std::clamp(agreement.time_offset + duration_from_seconds(std::clamp(step_s, -0.02, 0.02)),
                                       expected - most, expected + most);
    agreement.turns = pairs.camera.size();
    agreement.R_B_C = fit.R;
    agreement.gyro_scale = fit.scale;
    std::vector<double> speeds;
    for (const Eigen::Vector3d& turn : pairs.camera) speeds.push_back(turn.norm());
    agreement.unexplained = fit.median_error / std::max(median(speeds), 1e-9);
  }
  agreement.rotation_covariance += scatter_of(pairs, agreement.R_B_C);
  agreement.rotation_sigma = std::sqrt(agreement.rotation_covariance.selfadjointView<Eigen::Lower>().eigenvalues()[2]);
  use_rays(turns, gyro, expected, agreement);
  agreement.common_error = common_error_of(agreement);
  agreement.turning = turning_time(turns);
  agreement.at_bound = std::chrono::abs(agreement.time_offset - expected) > most - kShiftStep;
  return agreement;
}

}  // namespace

std::optional<GyroAgreement> compare_with_gyro(std::span<const Turn> turns, const GyroIntegral& gyro,
                                               Duration expected) {
  // A rotation by 180 deg is equivalent to two negated axes: then the unexplained share must be small.
  constexpr double kDoubtful = 0.03, kFarBetter = 0.5;
  auto given = compare_as_given(turns, gyro, expected);
  if (given && given->at_bound)
    if (auto far = compare_as_given(turns, gyro, expected, kFarthestShift); far && !far->at_bound)
      given = std::move(far);
  if (!given || given->unexplained < kDoubtful) return given;
  std::vector<Turn> negated(turns.begin(), turns.end());
  for (Turn& turn : negated) {
    turn.phi_C = -turn.phi_C;
    for (auto& [begin, end] : turn.rays) std::swap(begin, end);
  }
  auto mirrored = compare_as_given(negated, gyro, expected);
  if (!mirrored || mirrored->unexplained > kFarBetter * std::min(given->unexplained, 2 * kUnlike)) return given;
  mirrored->mirrored = true;
  return mirrored;
}

double grossly_off_deg(std::span<const Turn> turns, const GyroIntegral& gyro, const RigCamera& given,
                       const GyroAgreement& found) {
  // Mirror recordings, two people in view included: correct calibrations reach 22 deg and 1.22 times the error, but not
  // both; those wrong by 90 deg have at least 80 deg and 1.20 times.
  constexpr double kGross = 45.0 * kDegree, kClearlyWorse = 1.15;
  constexpr double kByChance = 3.0;  // sigmas, where only turns that do not overlap are independent
  const double off = so3::log(given.T_B_C.rotation().conjugate() * Eigen::Quaterniond(found.R_B_C)).norm();
  std::vector<double> errors_found, errors_given;
  double balance = 0.0;  // of the turns that each explains better
  for (const Turn& turn : turns) {
    const auto error = [&](Duration shift, const Eigen::Matrix3d& R_B_C) {
      const auto phi = gyro.between(turn.begin + shift, turn.end + shift);
      return phi ? (*phi / found.gyro_scale - R_B_C * turn.phi_C).norm() / to_seconds(turn.end - turn.begin) : NAN;
    };
    const double by_found = error(found.time_offset, found.R_B_C), by_given = error(given.time_offset, given.T_B_C.R());
    if (!std::isfinite(by_found + by_given)) continue;
    errors_found.push_back(by_found);
    errors_given.push_back(by_given);
    balance += by_found < by_given ? 1.0 : -1.0;
  }
  if (off < kGross || errors_found.empty()) return 0.0;
  const bool by_chance = balance < kByChance * std::sqrt(static_cast<double>(errors_found.size()) * overlap_of(turns));
  return by_chance || median(errors_given) < kClearlyWorse * median(errors_found) ? 0.0 : off * kDegreesPerRadian;
}

}  // namespace edged
