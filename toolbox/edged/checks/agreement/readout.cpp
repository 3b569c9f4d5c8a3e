// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/readout.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "edged/checks/agreement/ray_fit.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestReadRays = 12;

/// A turn, and what the gyro says of it, in the axes of the camera.
struct TurnOfRows {
  const Turn& turn;
  Eigen::Matrix3d R;                            ///< from end to begin
  Eigen::Vector3d rate_begin, rate_end;         ///< [rad/s]
  std::vector<std::pair<double, double>> rows;  ///< of each corner at begin and end, -0.5 to 0.5
};

std::vector<TurnOfRows> with_rows(std::span<const Turn> turns, const GyroIntegral& gyro, const CameraModel& camera,
                                  const GyroAgreement& agreement) {
  constexpr Duration kAround = std::chrono::milliseconds(8);
  const Eigen::Matrix3d R_C_B = agreement.R_B_C.transpose() / agreement.gyro_scale;
  const auto rate_at = [&](Timestamp t) {
    return gyro.rotation_vector(t + agreement.time_offset - kAround, t + agreement.time_offset + kAround);
  };
  const auto row_of = [&camera](const Eigen::Vector3d& ray) {
    return camera.distort_to_pixel(ray.hnormalized()).y() / camera.height() - 0.5;
  };
  std::vector<TurnOfRows> all;
  for (const Turn& turn : turns) {
    const auto phi = gyro.rotation_vector(turn.begin + agreement.time_offset, turn.end + agreement.time_offset);
    const auto begin = rate_at(turn.begin), end = rate_at(turn.end);
    if (turn.rays.size() < kFewestReadRays || !phi || !begin || !end) continue;
    const double per_s = 0.5 / to_seconds(kAround);
    TurnOfRows rows{turn,
                    so3::exp(Eigen::Vector3d(R_C_B * *phi)).toRotationMatrix(),
                    per_s * R_C_B * *begin,
                    per_s * R_C_B * *end,
                    {}};
    for (const auto& [from, to] : turn.rays) rows.rows.emplace_back(row_of(from), row_of(to));
    all.push_back(std::move(rows));
  }
  return all;
}

/// The rays as a global shutter would see them.
Turn unrolled(const TurnOfRows& of, double readout_s) {
  Turn turn{of.turn.begin, of.turn.end};
  for (std::size_t i = 0; i < of.rows.size(); ++i) {
    const auto& [from, to] = of.turn.rays[i];
    const auto seen_at = [readout_s](const Eigen::Vector3d& ray, const Eigen::Vector3d& rate, double row) {
      return Eigen::Vector3d(so3::exp(Eigen::Vector3d(readout_s * row * rate)) * ray);
    };
    turn.rays.emplace_back(seen_at(from, of.rate_begin, of.rows[i].first), seen_at(to, of.rate_end, of.rows[i].second));
  }
  return turn;
}

/// The cost with rotation and translation of each turn free: loss + h step^2 / 2 - g step for a step of the readout.
struct RowTerms {
  double h = 0.0, g = 0.0, loss = 0.0;

  RowTerms& operator+=(const RowTerms& other) {
    h += other.h, g += other.g, loss += other.loss;
    return *this;
  }
};

RowTerms row_terms_of(const TurnOfRows& of, double readout_s, double spread, std::vector<double>& errors) {
  const Turn turn = unrolled(of, readout_s);
  const EpipolarErrors epipolar(turn, of.R, spread);
  Eigen::Matrix<double, 6, 6> H = 1e-12 * Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  double loss = 0.0;
  for (std::size_t i = 0; i < turn.rays.size(); ++i) {
    const auto& [from, to] = turn.rays[i];
    const auto [error, by_others] = epipolar.of(from, to);
    const Eigen::Vector3d from_slope = of.rows[i].first * of.rate_begin.cross(from);
    const Eigen::Vector3d to_slope = of.rows[i].second * of.rate_end.cross(to);
    Eigen::Matrix<double, 6, 1> J;
    J << by_others, epipolar.t().dot(from_slope.cross(of.R * to) + from.cross(of.R * to_slope));
    const double weight = 1.0 / (1.0 + std::pow(error / spread, 2));
    loss += -0.5 * std::log(weight) * spread * spread;
    H += weight * J * J.transpose();
    g -= weight * error * J;
    errors.push_back(std::abs(error));
  }
  const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> others(H.topLeftCorner<5, 5>());
  const Eigen::Matrix<double, 5, 1> step = others.solve(g.head<5>()), cross = H.topRightCorner<5, 1>();
  return {H(5, 5) - cross.dot(others.solve(cross)), g[5] - cross.dot(step), loss - 0.5 * g.head<5>().dot(step)};
}

/// The tenths of the recording.
using Tenths = std::array<RowTerms, kTimeBlocks>;

Tenths tenths_at(std::span<const TurnOfRows> turns, double readout_s, double spread, std::vector<double>& errors) {
  Tenths tenths;
  for (std::size_t i = 0; i < turns.size(); ++i)
    tenths[i * kTimeBlocks / turns.size()] += row_terms_of(turns[i], readout_s, spread, errors);
  return tenths;
}

RowTerms sum_of(const Tenths& tenths) {
  return std::accumulate(tenths.begin(), tenths.end(), RowTerms(),
                         [](RowTerms a, const RowTerms& b) { return a += b; });
}

}  // namespace

std::optional<Readout> readout_of(std::span<const Turn> turns, const GyroIntegral& gyro, const CameraModel& camera,
                                  const GyroAgreement& agreement) {
  constexpr int kRounds = 6;
  constexpr double kFirstSpread = 2e-3, kLeastSpread = 1e-4;  // [rad]
  const std::vector<TurnOfRows> all = with_rows(turns, gyro, camera, agreement);
  if (all.size() < kFewestTurnsToFit) return std::nullopt;
  Readout found;
  double spread = kFirstSpread;
  Tenths tenths;
  RowTerms sum;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> errors;
    tenths = tenths_at(all, found.s, spread, errors);
    sum = sum_of(tenths);
    if (!(sum.h > 0.0)) return std::nullopt;
    found.s += std::clamp(sum.g / sum.h, -0.02, 0.02);
    if (round + 1 < kRounds) spread = std::max(1.4826 * 2 * median(errors), kLeastSpread);
  }
  double squares = 0.0;  // by leaving out a tenth at a time, as corners are correlated over seconds
  for (const RowTerms& tenth : tenths) squares += std::pow((sum.g - tenth.g) / (sum.h - tenth.h) - sum.g / sum.h, 2);
  found.sigma_s = std::sqrt((kTimeBlocks - 1.0) / kTimeBlocks * squares);
  std::vector<double> unused;
  // With weak rotation the steps may end where the rays fit worse than without a readout.
  if (sum.loss > sum_of(tenths_at(all, 0.0, spread, unused)).loss) return std::nullopt;
  return found;
}

}  // namespace edged
