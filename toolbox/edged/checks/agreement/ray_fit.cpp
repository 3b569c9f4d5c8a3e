// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/ray_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr int kParameters = 8;  // rotation, shift, bias, ln of the gyro's scale
constexpr int kShiftAt = 3;
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using Information = Eigen::Matrix<double, kParameters, kParameters>;

/// The cost of one rotation, with free translation: cost ~ step^T H step / 2 - g^T step for
/// R_begin_end * Exp(step).
struct TurnTerms {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  std::vector<double> errors;  ///< [rad]
  double loss = 0.0;           ///< sum of the Cauchy losses
};

/// spread: the scale of the Cauchy loss of the errors.
TurnTerms terms_of(const Turn& turn, const Eigen::Matrix3d& R, double spread) {
  const EpipolarErrors epipolar(turn, R, spread);
  Eigen::Matrix<double, 5, 5> H = 1e-12 * Eigen::Matrix<double, 5, 5>::Identity();
  Eigen::Matrix<double, 5, 1> g = Eigen::Matrix<double, 5, 1>::Zero();
  TurnTerms terms;
  for (const auto& [from, to] : turn.rays) {
    const auto [error, J] = epipolar.of(from, to);
    const double squared = std::pow(error / spread, 2), weight = 1.0 / (1.0 + squared);
    terms.loss += std::log1p(squared);
    H += weight * J * J.transpose();
    g -= weight * error * J;
    terms.errors.push_back(std::abs(error));
  }
  const Eigen::Matrix2d inverse = H.bottomRightCorner<2, 2>().inverse();
  const Eigen::Matrix<double, 3, 2> cross = H.topRightCorner<3, 2>();
  terms.H = H.topLeftCorner<3, 3>() - cross * inverse * cross.transpose();
  terms.g = g.head<3>() - cross * inverse * g.tail<2>();
  return terms;
}

/// The rotation of the gyro in the camera frame, and its derivatives with respect to the parameters.
struct Predicted {
  Eigen::Vector3d phi_C;
  Eigen::Matrix3d R;
  Eigen::Matrix<double, 3, kParameters> J;
};

std::optional<Predicted> predict(const Turn& turn, const GyroIntegral& gyro, const GyroMount& mount) {
  constexpr Duration kStep = std::chrono::milliseconds(1);
  const Duration shift = duration_from_seconds(mount.shift_s);
  const auto at = [&](Duration by) { return gyro.rotation_vector(turn.begin + by, turn.end + by); };
  const auto now = at(shift), before = at(shift - kStep), after = at(shift + kStep);
  if (!now || !before || !after) return std::nullopt;
  const double dt = to_seconds(turn.end - turn.begin);
  const Eigen::Matrix3d R_C_B = mount.R_B_C.transpose();
  Predicted predicted;
  predicted.phi_C = R_C_B * (*now / mount.gyro_scale - mount.bias * dt);
  predicted.R = so3::exp(predicted.phi_C).toRotationMatrix();
  predicted.J << Eigen::Matrix3d::Identity() - predicted.R.transpose(),
      R_C_B * (*after - *before) / (2 * to_seconds(kStep)) / mount.gyro_scale, -R_C_B * dt,
      -R_C_B * *now / mount.gyro_scale;
  predicted.J.rightCols<5>() = so3::right_jacobian(predicted.phi_C) * predicted.J.rightCols<5>().eval();
  return predicted;
}

struct Normal {
  Information H = Information::Zero();
  Parameters g = Parameters::Zero();
  double loss = 0.0;
};

/// All rotations for one mount.
struct Sums {
  std::array<Normal, kTimeBlocks> blocks;
  std::size_t turns = 0;
  std::vector<double> errors, unexplained, turning;

  double unexplained_share() const { return std::sqrt(median(unexplained) / std::max(median(turning), 1e-12)); }
  Normal total() const {
    Normal all;
    for (const Normal& block : blocks) all.H += block.H, all.g += block.g;
    return all;
  }
};

Sums sums_at(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& mount, double spread) {
  Sums sums;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (turns[i].rays.empty()) continue;
    const auto predicted = predict(turns[i], gyro, mount);
    if (!predicted) continue;
    const TurnTerms terms = terms_of(turns[i], predicted->R, spread);
    Normal& block = sums.blocks[i * kTimeBlocks / turns.size()];
    block.H += predicted->J.transpose() * terms.H * predicted->J;
    block.g += predicted->J.transpose() * terms.g;
    block.loss += terms.loss;
    sums.unexplained.push_back(terms.g.dot((terms.H + 1e-9 * Eigen::Matrix3d::Identity()).ldlt().solve(terms.g)));
    sums.turning.push_back(predicted->phi_C.dot(terms.H * predicted->phi_C));
    sums.errors.insert(sums.errors.end(), terms.errors.begin(), terms.errors.end());
    ++sums.turns;
  }
  return sums;
}

constexpr double kHeld = 1e-6, kFreeScale = 0.3;  // sigmas of ln of the gyro's scale

/// Priors, which keep unobservable parameters at their initial values: biases are below 0.1 rad/s.
Normal with_prior(const Normal& data, const GyroMount& mount, double variance, double scale_sigma) {
  Parameters sigmas, step = Parameters::Zero();
  sigmas << Eigen::Vector3d::Ones(), 0.05, Eigen::Vector3d::Constant(0.1), scale_sigma;
  step.segment<3>(4) = -mount.bias;
  step[7] = -std::log(mount.gyro_scale);
  const Parameters weights = variance * sigmas.array().square().inverse();
  return {data.H + Information(weights.asDiagonal()), data.g + weights.cwiseProduct(step)};
}

void move(GyroMount& mount, const Parameters& step) {
  const double length = step.head<3>().norm();
  const Eigen::Vector3d turn = step.head<3>() * std::min(1.0, 0.3 / std::max(length, 1e-12));
  mount.R_B_C = mount.R_B_C * so3::exp(turn).toRotationMatrix();
  mount.shift_s += std::clamp(step[kShiftAt], -0.02, 0.02);
  mount.bias += step.segment<3>(4);
  mount.gyro_scale *= std::exp(std::clamp(step[7], -0.2, 0.2));
}

/// Errors of corners are correlated over seconds, so rotations are not independent: leaving out a tenth of the
/// recording at a time (Efron and Tibshirani 1993, the jackknife by blocks) gives a better covariance than the normal
/// equations, except in unobservable directions.
Information covariance_of(const Sums& sums, const GyroMount& mount, double variance, double scale_sigma) {
  const Normal all = sums.total();
  Information covariance = variance * with_prior(all, mount, variance, scale_sigma).H.inverse();
  for (const Normal& block : sums.blocks) {
    const Normal kept = with_prior({all.H - block.H, all.g - block.g}, mount, variance, scale_sigma);
    const Parameters change = kept.H.ldlt().solve(kept.g);
    covariance += (kTimeBlocks - 1.0) / kTimeBlocks * change * change.transpose();
  }
  return covariance;
}

/// Student's t of the tenths of the recording that the found sums fit better than those of another mount. Signed roots
/// of the differences of a likelihood have a common variance, however much each tenth turns.
double preference(const Sums& found, const Sums& other) {
  std::array<double, kTimeBlocks> roots;
  for (std::size_t i = 0; i < kTimeBlocks; ++i) {
    const double less = other.blocks[i].loss - found.blocks[i].loss;
    roots[i] = std::copysign(std::sqrt(std::abs(less)), less);
  }
  const double n = kTimeBlocks, mean = std::accumulate(roots.begin(), roots.end(), 0.0) / n;
  double squares = 0.0;
  for (const double root : roots) squares += std::pow(root - mean, 2);
  return squares > 0.0 ? mean / std::sqrt(squares / (n - 1) / n) : 0.0;
}

/// What moves by a second of shift, all else following it by the normal equations.
Parameters along_shift(const Information& H) {
  const Parameters along = H.ldlt().solve(Parameters::Unit(kShiftAt));
  return along / along[kShiftAt];
}

/// How clearly the tenths of the recording prefer the mount to one whose shift is `by_s` larger.
double preference(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& mount, const Sums& sums,
                  double spread, const Parameters& along, double by_s) {
  GyroMount moved = mount;
  move(moved, by_s * along);
  moved.shift_s = mount.shift_s + by_s;
  return preference(sums, sums_at(turns, gyro, moved, spread));
}

/// A third of the shift from which on the tenths of the recording refute any to both sides by a t of 1.3, which
/// independent errors reach at 3 sigma (simulated, median). The scatter that vibration and moving objects give to each
/// part is contained, and other minima of the cost.
double shift_sigma(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& mount, const Sums& sums,
                   double spread, const Parameters& along) {
  constexpr double kFarthest_s = 0.064, kNearest_s = 1e-4, kRefuted = 1.3;
  double beyond_s = 2 * kFarthest_s;
  for (double by_s = kFarthest_s; by_s > kNearest_s; beyond_s = by_s, by_s /= 2)
    for (const double side : {-by_s, by_s})
      if (preference(turns, gyro, mount, sums, spread, along, side) < kRefuted) return beyond_s / 3;
  return beyond_s / 3;
}

/// The scale is estimated last: most gyros have a correct one, and it should not affect the other estimates.
void fit_scale(std::span<const Turn> turns, const GyroIntegral& gyro, double spread, RayFit& fit) {
  constexpr int kRounds = 5;
  GyroMount mount = fit.mount;
  Sums sums = sums_at(turns, gyro, mount, spread);
  for (int round = 0; round < kRounds; ++round) {
    const Normal all = with_prior(sums.total(), mount, spread * spread / 4, kFreeScale);
    move(mount, all.H.ldlt().solve(all.g));
    sums = sums_at(turns, gyro, mount, spread);
  }
  fit.mount.gyro_scale = mount.gyro_scale;
  fit.scale_unexplained = sums.unexplained_share();
  fit.scale_sigma = mount.gyro_scale * std::sqrt(covariance_of(sums, mount, spread * spread / 4, kFreeScale)(7, 7));
}

}  // namespace

EpipolarErrors::EpipolarErrors(const Turn& turn, const Eigen::Matrix3d& R_begin_end, double spread)
    : R_(R_begin_end), t_(Eigen::Vector3d::Zero()) {
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
    for (const auto& [from, to] : turn.rays) {
      const Eigen::Vector3d n = from.cross(R_ * to);
      M += n * n.transpose() / (1.0 + (round > 0 ? std::pow(n.dot(t_) / spread, 2) : 0.0));
    }
    t_ = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(M).eigenvectors().col(0);
  }
  a_ = t_.unitOrthogonal();
  b_ = t_.cross(a_);
}

EpipolarErrors::Error EpipolarErrors::of(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  const Eigen::Vector3d n = from.cross(R_ * to);
  Error error{n.dot(t_), {}};
  // t . (from x R (step x to)) = step . (to x R^T (t x from))
  error.J << to.cross(R_.transpose() * t_.cross(from)), n.dot(a_), n.dot(b_);
  return error;
}

Eigen::Vector3d translation_direction(const Turn& turn, const Eigen::Matrix3d& R_begin_end) {
  constexpr double kSpread = 1e-3;  // [rad]
  constexpr double kAgree = 0.6;    // least share of agreeing corners minus contradicting ones: points lie in front
  const Eigen::Vector3d t = EpipolarErrors(turn, R_begin_end, kSpread).t();
  double votes = 0.0;
  for (const auto& [from, to] : turn.rays) votes += (from - R_begin_end * to).dot(t) > 0.0 ? 1.0 : -1.0;
  if (std::abs(votes) < kAgree * static_cast<double>(turn.rays.size())) return Eigen::Vector3d::Zero();
  return votes > 0.0 ? t : Eigen::Vector3d(-t);
}

std::optional<RayFit> fit_rays(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& start,
                               double given_s) {
  constexpr int kRounds = 12;
  constexpr double kFirstSpread = 2e-3, kLeastSpread = 1e-4;  // [rad]
  RayFit fit{.mount = start};
  double spread = kFirstSpread;
  Sums sums;
  for (int round = 0;; ++round) {
    sums = sums_at(turns, gyro, fit.mount, spread);
    if (sums.turns < kFewestTurnsToFit) return std::nullopt;
    spread = std::max(1.4826 * 2 * median(sums.errors), kLeastSpread);
    if (round == kRounds) break;
    const Normal all = with_prior(sums.total(), fit.mount, spread * spread / 4, kHeld);
    move(fit.mount, all.H.ldlt().solve(all.g));
  }
  sums = sums_at(turns, gyro, fit.mount, spread);
  const double variance = spread * spread / 4;
  const Information covariance = covariance_of(sums, fit.mount, variance, kHeld);
  fit.rotation_covariance = covariance.topLeftCorner<3, 3>();
  const Parameters along = along_shift(with_prior(sums.total(), fit.mount, variance, kHeld).H);
  fit.shift_sigma_s = shift_sigma(turns, gyro, fit.mount, sums, spread, along);
  fit.shift_t = preference(turns, gyro, fit.mount, sums, spread, along, given_s - fit.mount.shift_s);
  fit.unexplained = sums.unexplained_share();
  fit_scale(turns, gyro, spread, fit);
  return fit;
}

}  // namespace edged
