// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/map_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kCauchy = 2.0;             // [sigma]
constexpr double kMedianOfSquares = 1.386;  // of a two-dimensional unit normal

Eigen::Index block_of(std::size_t keyframe) { return 6 * static_cast<Eigen::Index>(keyframe + 1); }

}  // namespace

void MapFilter::restart(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double position_sigma, double yaw_sigma) {
  T_O_B_ = T_O_B;
  T_M_B_ = T_M_O * T_O_B;
  t_ = t;
  const Eigen::Vector3d up_B = T_M_B_.R().transpose() * Eigen::Vector3d::UnitZ();
  P_.topRows<6>().setZero();
  P_.leftCols<6>().setZero();
  P_.topLeftCorner<3, 3>() = position_sigma * position_sigma * Eigen::Matrix3d::Identity();
  P_.block<3, 3>(3, 3) = yaw_sigma * yaw_sigma * up_B * up_B.transpose();
}

void MapFilter::predict(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double drift) {
  const Matrix6d F = transport(T_M_B_, T_O_B_.inverse() * T_O_B);
  const Eigen::Matrix<double, Eigen::Dynamic, 6> moved = P_.leftCols<6>() * F.transpose();
  P_.leftCols<6>() = moved;
  P_.topRows<6>() = moved.transpose();
  T_O_B_ = T_O_B;
  T_M_B_ = T_M_O * T_O_B;
  P_.topLeftCorner<6, 6>() =
      F * moved.topRows<6>() + drift * drift * drift_covariance(config_, T_M_B_, std::max(to_seconds(t - t_), 0.0));
  t_ = t;
}

void MapFilter::add_keyframe(const SE3& T_M_O, const SE3& T_O_K, Timestamp t) {
  const Matrix6d F = transport(T_M_B_, T_O_B_.inverse() * T_O_K);
  const Eigen::Index n = P_.rows();
  MatrixXd grown(n + 6, n + 6);
  grown.topLeftCorner(n, n) = P_;
  grown.bottomLeftCorner(6, n) = F * P_.topRows<6>();
  grown.topRightCorner(n, 6) = grown.bottomLeftCorner(6, n).transpose();
  T_M_K_.push_back(T_M_O * T_O_K);
  grown.bottomRightCorner<6, 6>() = F * P_.topLeftCorner<6, 6>() * F.transpose() +
                                    drift_covariance(config_, T_M_K_.back(), std::abs(to_seconds(t_ - t)));
  P_ = std::move(grown);
}

void MapFilter::load(std::vector<SE3> T_M_K, const MatrixXd& covariance) {
  T_M_K_ = std::move(T_M_K);
  P_ = MatrixXd::Zero(6 + covariance.rows(), 6 + covariance.cols());
  P_.bottomRightCorner(covariance.rows(), covariance.cols()) = covariance;
}

MatrixXd MapFilter::keyframe_covariance() const { return P_.bottomRightCorner(P_.rows() - 6, P_.cols() - 6); }

void MapFilter::remove_keyframe(std::size_t keyframe) {
  const Eigen::Index k = block_of(keyframe), after = P_.rows() - k - 6;
  P_.middleRows(k, after) = P_.bottomRows(after).eval();
  P_.middleCols(k, after) = P_.rightCols(after).eval();
  P_.conservativeResize(k + after, k + after);
  T_M_K_.erase(T_M_K_.begin() + static_cast<std::ptrdiff_t>(keyframe));
}

std::optional<LinearizedObservation> MapFilter::linearise(const MapObservation& observation, const SE3& T_B_C) const {
  return linearised(observation, T_M_B_, T_M_K_[observation.keyframe], T_B_C);
}

Eigen::Matrix2d MapFilter::expected_covariance(const LinearizedObservation& row, std::size_t keyframe) const {
  const Eigen::Index k = block_of(keyframe);
  const Eigen::Matrix2d cross = row.by_body * P_.block<6, 6>(0, k) * row.by_keyframe.transpose();
  return row.R + row.by_body * P_.topLeftCorner<6, 6>() * row.by_body.transpose() + cross + cross.transpose() +
         row.by_keyframe * P_.block<6, 6>(k, k) * row.by_keyframe.transpose();
}

double MapFilter::expected_error(const MapObservation& observation, const SE3& T_B_C) const {
  const std::optional<LinearizedObservation> row = linearise(observation, T_B_C);
  return row ? std::sqrt(expected_covariance(*row, observation.keyframe).trace()) : 0.0;
}

/// Returns T_M_O.
SE3 MapFilter::correct(const VectorXd& error) {
  const SE3 T_M_O = corrected(T_M_B_, error.head<6>()) * T_O_B_.inverse();
  T_M_B_ = T_M_O * T_O_B_;
  for (std::size_t k = 0; k < T_M_K_.size() && !fixed_keyframes_; ++k)
    T_M_K_[k] = corrected(T_M_K_[k], error.segment<6>(block_of(k)));
  return T_M_O;
}

/// The part of the rows in the normal equations of the body and the observed keyframes, with a robust loss.
MapFilter::Information MapFilter::gather(std::span<const MapObservation> observations,
                                         std::span<const LinearizedObservation> rows) const {
  Information sum;
  for (const MapObservation& observation : observations) sum.place.try_emplace(observation.keyframe, 0);
  Eigen::Index m = 6;
  for (auto& [keyframe, at] : sum.place) at = std::exchange(m, m + 6);
  sum.H = MatrixXd::Zero(m, m);
  sum.g = VectorXd::Zero(m);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LinearizedObservation& row = rows[i];
    const double squared = row.r.dot(expected_covariance(row, observations[i].keyframe).inverse() * row.r);
    const Eigen::Matrix2d W = row.R.inverse() / (1.0 + squared / (kCauchy * kCauchy));
    const Eigen::Index k = sum.place.at(observations[i].keyframe);
    const Eigen::Matrix<double, 6, 2> body_W = row.by_body.transpose() * W,
                                      keyframe_W = row.by_keyframe.transpose() * W;
    sum.H.topLeftCorner<6, 6>() += body_W * row.by_body;
    sum.H.block<6, 6>(0, k) += body_W * row.by_keyframe;
    sum.H.block<6, 6>(k, 0) += keyframe_W * row.by_body;
    sum.H.block<6, 6>(k, k) += keyframe_W * row.by_keyframe;
    sum.g.head<6>() += body_W * row.r;
    sum.g.segment<6>(k) += keyframe_W * row.r;
  }
  return sum;
}

/// Root of the median squared residual of the rows after the correction of the poses [sigma of each].
double MapFilter::misfit(std::span<const MapObservation> observations, std::span<const LinearizedObservation> rows,
                         const VectorXd& error) const {
  std::vector<double> squared;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector2d left = rows[i].r + rows[i].by_body * error.head<6>() +
                                 rows[i].by_keyframe * error.segment<6>(block_of(observations[i].keyframe));
    squared.push_back(left.dot(rows[i].R.inverse() * left));
  }
  return std::sqrt(median(std::move(squared)) / kMedianOfSquares);
}

std::optional<SE3> MapFilter::update(std::span<const MapObservation> observations, std::size_t expected,
                                     const std::vector<SE3>& T_B_C) {
  if (static_cast<int>(observations.size()) < config_.min_observations ||
      static_cast<double>(observations.size()) < config_.min_found_share * static_cast<double>(expected))
    return std::nullopt;
  std::vector<LinearizedObservation> rows;
  for (const MapObservation& observation : observations) {
    std::optional<LinearizedObservation> row = linearise(observation, T_B_C[observation.camera]);
    if (!row) return std::nullopt;
    rows.push_back(*row);
  }
  const auto [place, H, g] = gather(observations, rows);
  // P' = P - P_t (H^-1 + P_tt)^-1 P_t^T, t the blocks touched; H has no inverse: (H^-1 + P_tt)^-1 = (I + H P_tt)^-1 H.
  const Eigen::Index m = H.rows();
  MatrixXd P_t(P_.rows(), m), P_tt(m, m);
  P_t.leftCols<6>() = P_.leftCols<6>();
  for (const auto& [keyframe, at] : place) P_t.middleCols<6>(at) = P_.middleCols<6>(block_of(keyframe));
  P_tt.topRows<6>() = P_t.topRows<6>();
  for (const auto& [keyframe, at] : place) P_tt.middleRows<6>(at) = P_t.middleRows<6>(block_of(keyframe));
  const MatrixXd inverse = (MatrixXd::Identity(m, m) + H * P_tt).partialPivLu().inverse();
  // Keyframes without any correlation with these blocks do not change by a bit.
  std::vector<Eigen::Index> moved;
  for (Eigen::Index row = 0; row < P_t.rows(); ++row) {
    if (!P_t.row(row).isZero(0.0)) moved.push_back(row);
  }
  const MatrixXd P_m = P_t(moved, Eigen::all);
  VectorXd error = VectorXd::Zero(P_.rows());
  error(moved) = -P_m * (inverse * g);
  if (!(misfit(observations, rows, error) < config_.max_misfit)) return std::nullopt;
  shrink(moved, P_m, inverse * H);
  return correct(error);
}

/// P -= P_m A P_m^T in the rows and columns m: a half of it, and the other as that. Of fixed keyframes only their
/// correlation with the body, which comes first.
void MapFilter::shrink(std::span<const Eigen::Index> m, const MatrixXd& P_m, const MatrixXd& A) {
  const auto n = static_cast<Eigen::Index>(m.size());
  MatrixXd less(n, n);
  less.triangularView<Eigen::Lower>() = (P_m * A).eval() * P_m.transpose();
  for (Eigen::Index j = 0; j < n && (!fixed_keyframes_ || m[j] < 6); ++j) {
    for (Eigen::Index i = j; i < n; ++i) P_(m[j], m[i]) = P_(m[i], m[j]) -= less(i, j);
  }
}

}  // namespace edged
