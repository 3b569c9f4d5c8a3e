// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/map_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "edged/core/statistics.hpp"
#include "edged/map/tuning.hpp"

namespace edged {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMedianOfSquares = 1.386;  // of a two-dimensional unit normal

}  // namespace

void MapFilter::restart(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double position_sigma, double yaw_sigma,
                        double tilt_sigma) {
  T_O_B_ = T_O_B;
  T_M_B_ = T_M_O * T_O_B;
  t_ = updated_ = t;
  P_.topRows<6>().setZero();
  P_.leftCols<6>().setZero();
  P_.topLeftCorner<3, 3>() = position_sigma * position_sigma * Eigen::Matrix3d::Identity();
  P_.block<3, 3>(3, 3) = rotation_covariance(T_M_B_, square(yaw_sigma), square(tilt_sigma));
  if (tilt_sigma > 0.0) tilt_sigma_ = tilt_sigma;
  updated_tilt_sigma_ = tilt_sigma_;
}

void MapFilter::set_tilt_sigma(double sigma) {
  sigma = std::max(sigma, kMapTuning.least_tilt_deg * kDegree);
  P_.block<3, 3>(3, 3) += rotation_covariance(T_M_B_, 0.0, std::max(square(tilt_sigma_) - square(sigma), 0.0));
  tilt_sigma_ = sigma;
}

void MapFilter::predict(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, const Drift& drift) {
  deactivate_beyond_limit();
  const Matrix6d F = transport(T_M_B_, T_O_B_.inverse() * T_O_B);
  const Eigen::Matrix<double, Eigen::Dynamic, 6> moved = P_.leftCols<6>() * F.transpose();
  P_.leftCols<6>() = moved;
  P_.topRows<6>() = moved.transpose();
  T_O_B_ = T_O_B;
  T_M_B_ = T_M_O * T_O_B;
  drift_ = drift;
  P_.topLeftCorner<6, 6>() =
      F * moved.topRows<6>() + drift_covariance(drift, T_M_B_, std::max(to_seconds(t - t_), 0.0));
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
  activated_.push_back(t_);
  row_.push_back(n);
  grown.bottomRightCorner<6, 6>() = F * P_.topLeftCorner<6, 6>() * F.transpose() +
                                    drift_covariance(drift_, T_M_K_.back(), std::abs(to_seconds(t_ - t)));
  P_ = std::move(grown);
}

void MapFilter::load(std::vector<SE3> T_M_K, const MatrixXd& covariance, std::span<const ConditionalPose> inactive) {
  T_M_K_ = std::move(T_M_K);
  activated_.assign(T_M_K_.size(), Timestamp::min());
  row_.assign(T_M_K_.size(), 0);
  inactive_ = InactiveKeyframes();
  for (const ConditionalPose& pose : inactive) {
    inactive_.add(pose);
    row_[pose.keyframe] = kInactive;
  }
  P_ = MatrixXd::Zero(6 + covariance.rows(), 6 + covariance.cols());
  P_.bottomRightCorner(covariance.rows(), covariance.cols()) = covariance;
  Eigen::Index next = 6;
  for (const std::size_t keyframe : active()) row_[keyframe] = std::exchange(next, next + 6);
}

MatrixXd MapFilter::keyframe_covariance() const { return P_.bottomRightCorner(P_.rows() - 6, P_.cols() - 6); }

void MapFilter::remove_keyframe(std::size_t keyframe) {
  if (inactive_.depend_on(keyframe) && !inactive_.contains(keyframe)) deactivate(std::array{keyframe});
  inactive_.remove(keyframe);
  const auto at = static_cast<std::ptrdiff_t>(keyframe);
  T_M_K_.erase(T_M_K_.begin() + at);
  activated_.erase(activated_.begin() + at);
  row_.erase(row_.begin() + at);
  select_rows();
}

/// In order of their rows.
std::vector<std::size_t> MapFilter::active() const {
  std::vector<std::size_t> keyframes;
  for (std::size_t k = 0; k < row_.size(); ++k) {
    if (row_[k] != kInactive) keyframes.push_back(k);
  }
  return keyframes;
}

/// Drops the rows of P_ that belong to no keyframe any more, and sorts the others by keyframe.
void MapFilter::select_rows() {
  std::vector<Eigen::Index> rows = {0, 1, 2, 3, 4, 5};
  for (const std::size_t keyframe : active()) {
    const Eigen::Index first = std::exchange(row_[keyframe], std::ssize(rows));
    for (Eigen::Index i = 0; i < 6; ++i) rows.push_back(first + i);
  }
  P_ = P_(rows, rows).eval();
}

void MapFilter::deactivate_beyond_limit() {
  std::vector<std::size_t> keyframes = active();
  const std::ptrdiff_t many = std::ssize(keyframes) - max_active_;
  if (many <= 0) return;
  std::ranges::stable_sort(keyframes, {}, [&](std::size_t k) { return activated_[k]; });
  deactivate(std::span(keyframes).first(static_cast<std::size_t>(many)));
}

/// One after the other, each conditional on those that are active still.
void MapFilter::deactivate(std::span<const std::size_t> keyframes) {
  for (const std::size_t keyframe : keyframes) {
    const Eigen::Index row = std::exchange(row_[keyframe], kInactive);
    inactive_.add(conditional(keyframe, row));
  }
  select_rows();
}

/// Its error given those of few others: one after the other that which leaves it least uncertain. row: its own in P_.
ConditionalPose MapFilter::conditional(std::size_t keyframe, Eigen::Index row) const {
  std::vector<std::uint32_t> parents, others;
  for (const std::size_t other : active()) others.push_back(static_cast<std::uint32_t>(other));
  const auto given = [&] {
    std::vector<Eigen::Index> rows(6 * (parents.size() + 1));
    std::iota(rows.begin(), rows.begin() + 6, row);
    for (std::size_t i = 0; i < parents.size(); ++i)
      std::iota(rows.begin() + 6 * (i + 1), rows.begin() + 6 * (i + 2), row_[parents[i]]);
    return conditional_pose(static_cast<std::uint32_t>(keyframe), parents, P_(rows, rows));
  };
  while (!others.empty() && parents.size() < kMapTuning.parents) {
    std::vector<std::pair<double, std::uint32_t>> left;  // volume of its error
    for (const std::uint32_t other : others) {
      parents.push_back(other);
      left.emplace_back(
          Matrix6d(given().covariance + ConditionalPose::kLeastVariance * Matrix6d::Identity()).determinant(), other);
      parents.pop_back();
    }
    std::ranges::sort(left);
    parents.push_back(left.front().second);
    others.clear();
    for (std::size_t i = 1; i < std::min(left.size(), kMapTuning.parent_candidates); ++i)
      others.push_back(left[i].second);
  }
  return given();
}

void MapFilter::activate(std::span<const std::uint32_t> keyframes) {
  for (const std::uint32_t keyframe : keyframes) activated_[keyframe] = t_;
  const std::vector<ConditionalPose> activated = inactive_.activate(keyframes);
  if (activated.empty()) return;
  const Eigen::Index n = P_.rows(), m = 6 * std::ssize(activated);
  P_.conservativeResize(n + m, n + m);
  P_.bottomRows(m).setZero();
  P_.rightCols(m).setZero();
  for (const ConditionalPose& pose : activated) {
    row_[pose.keyframe] = n + 6 * (&pose - activated.data());
    fill_rows(pose);
  }
  select_rows();
}

/// Its covariance with all others, which follows from that of its parents, and its own.
void MapFilter::fill_rows(const ConditionalPose& pose) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> cross = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, P_.cols());
  for (const ConditionalPose::Parent& parent : pose.parents)
    cross += parent.gain * P_.middleRows<6>(row_[parent.keyframe]);
  Matrix6d own = pose.covariance;
  for (const ConditionalPose::Parent& parent : pose.parents)
    own += cross.middleCols<6>(row_[parent.keyframe]) * parent.gain.transpose();
  const Eigen::Index row = row_[pose.keyframe];
  P_.middleRows<6>(row) = cross;
  P_.middleCols<6>(row) = cross.transpose();
  P_.block<6, 6>(row, row) = 0.5 * (own + own.transpose());
}

std::optional<LinearizedObservation> MapFilter::linearise(const MapObservation& observation, const SE3& T_B_C) const {
  return linearised(observation, T_M_B_, T_M_K_[observation.keyframe], T_B_C);
}

Eigen::Matrix2d MapFilter::expected_covariance(const LinearizedObservation& row, std::size_t keyframe) const {
  const Eigen::Index k = row_[keyframe];
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
  if (fixed_keyframes_) return T_M_O;
  std::vector<Vector6d> errors(T_M_K_.size());
  for (const std::size_t k : active()) errors[k] = error.segment<6>(row_[k]);
  inactive_.follow(errors);
  for (std::size_t k = 0; k < T_M_K_.size(); ++k) T_M_K_[k] = corrected(T_M_K_[k], errors[k]);
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
    const Eigen::Matrix2d W = row.R.inverse() / (1.0 + squared / (kMapTuning.cauchy_sigmas * kMapTuning.cauchy_sigmas));
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
double MapFilter::median_residual(std::span<const MapObservation> observations,
                                  std::span<const LinearizedObservation> rows, const VectorXd& error) const {
  std::vector<double> squared;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector2d left = rows[i].r + rows[i].by_body * error.head<6>() +
                                 rows[i].by_keyframe * error.segment<6>(row_[observations[i].keyframe]);
    squared.push_back(left.dot(rows[i].R.inverse() * left));
  }
  return std::sqrt(median(std::move(squared)) / kMedianOfSquares);
}

/// P' = P - P_t (H^-1 + P_tt)^-1 P_t^T, t the blocks touched; H has no inverse: (H^-1 + P_tt)^-1 = (I + H P_tt)^-1 H.
MapFilter::Update MapFilter::solved(const Information& sum) const {
  const Eigen::Index m = sum.H.rows();
  MatrixXd P_t(P_.rows(), m), P_tt(m, m);
  P_t.leftCols<6>() = P_.leftCols<6>();
  for (const auto& [keyframe, at] : sum.place) P_t.middleCols<6>(at) = P_.middleCols<6>(row_[keyframe]);
  P_tt.topRows<6>() = P_t.topRows<6>();
  for (const auto& [keyframe, at] : sum.place) P_tt.middleRows<6>(at) = P_t.middleRows<6>(row_[keyframe]);
  const MatrixXd inverse = (MatrixXd::Identity(m, m) + sum.H * P_tt).partialPivLu().inverse();
  // Keyframes without any correlation with these blocks do not change by a bit.
  Update update;
  for (Eigen::Index row = 0; row < P_t.rows(); ++row) {
    if (!P_t.row(row).isZero(0.0)) update.moved.push_back(row);
  }
  update.P_m = P_t(update.moved, Eigen::all);
  update.A = inverse * sum.H;
  update.error = VectorXd::Zero(P_.rows());
  update.error(update.moved) = -update.P_m * (inverse * sum.g);
  return update;
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
  Information sum = gather(observations, rows);
  add_gravity(sum);
  const Update update = solved(sum);
  if (!(median_residual(observations, rows, update.error) < config_.max_misfit)) return std::nullopt;
  update_covariance(update);
  updated_ = t_;
  updated_tilt_sigma_ = tilt_sigma_;
  return correct(update.error);
}

/// Adds the odometry's observation of gravity since the last update, and what it has learned of it since then.
void MapFilter::add_gravity(Information& sum) const {
  GravityObservation observed = observed_gravity(T_O_B_, to_seconds(t_ - updated_), tilt_sigma_);
  observed.information += std::max(1.0 / square(tilt_sigma_) - 1.0 / square(updated_tilt_sigma_), 0.0);
  const LinearizedGravity gravity = linearised(observed, T_M_B_);
  sum.H.block<3, 3>(3, 3) += gravity.H;
  sum.g.segment<3>(3) += gravity.g;
}

MapFilter::LinearizedPose MapFilter::linearise(std::size_t keyframe, const SE3& T_K_B) const {
  const SE3& T_M_K = T_M_K_[keyframe];
  const SE3 measured = T_M_K * T_K_B;
  LinearizedPose pose;
  pose.r << T_M_B_.translation() - measured.translation(),
      so3::log(measured.rotation().conjugate() * T_M_B_.rotation());
  pose.J << Matrix6d::Identity(), -transport(T_M_K, T_K_B);
  return pose;
}

/// The errors of a random walk at two times have the variance of the earlier one in common.
void MapFilter::inflate(std::span<const double> keyframes, double body, double heading_share) {
  struct Step {
    Eigen::Index row;
    double variance;
    Eigen::Vector3d up;  // in the pose's own frame
  };
  std::vector<Step> walk = {{0, body, T_M_B_.R().row(2)}};
  for (const std::size_t k : active()) walk.push_back({row_[k], keyframes[k], T_M_K_[k].R().row(2)});
  for (const Step& one : walk) {
    for (const Step& other : walk) {
      const double common = std::min(one.variance, other.variance);
      P_.block<3, 3>(one.row, other.row).diagonal().array() += common;
      P_.block<3, 3>(one.row + 3, other.row + 3) += heading_share * common * one.up * other.up.transpose();
    }
  }
}

double MapFilter::squared_distance(std::size_t keyframe, const SE3& T_K_B, const Matrix6d& covariance) const {
  const LinearizedPose pose = linearise(keyframe, T_K_B);
  const Eigen::Index k = row_[keyframe];
  Eigen::Matrix<double, 12, 12> P;
  P << P_.topLeftCorner<6, 6>(), P_.block<6, 6>(0, k), P_.block<6, 6>(k, 0), P_.block<6, 6>(k, k);
  return pose.r.dot(Matrix6d(pose.J * P * pose.J.transpose() + covariance).ldlt().solve(pose.r));
}

SE3 MapFilter::close(std::size_t keyframe, const SE3& T_K_B, const Matrix6d& covariance) {
  const LinearizedPose pose = linearise(keyframe, T_K_B);
  const Eigen::Matrix<double, 12, 6> weighed = pose.J.transpose() * covariance.inverse();
  Information sum{{{keyframe, 6}}, weighed * pose.J, weighed * pose.r};
  add_gravity(sum);
  const Update update = solved(sum);
  update_covariance(update);
  updated_ = t_;
  updated_tilt_sigma_ = tilt_sigma_;
  return correct(update.error);
}

/// P -= P_m A P_m^T in the rows and columns m: a half of it, and the other as that. Of fixed keyframes only their
/// correlation with the body, which comes first.
void MapFilter::update_covariance(const Update& update) {
  const std::span<const Eigen::Index> m = update.moved;
  const auto n = static_cast<Eigen::Index>(m.size());
  MatrixXd less(n, n);
  less.triangularView<Eigen::Lower>() = (update.P_m * update.A).eval() * update.P_m.transpose();
  for (Eigen::Index j = 0; j < n && (!fixed_keyframes_ || m[j] < 6); ++j) {
    for (Eigen::Index i = j; i < n; ++i) P_(m[j], m[i]) = P_(m[i], m[j]) -= less(i, j);
  }
}

}  // namespace edged
