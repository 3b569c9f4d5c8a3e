// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/rig_problem.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "edged/calibrate/solve_silently.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/estimator/factors/imu_factor.hpp"

namespace edged {
namespace {

// Of the biases at the start [rad/s, m/s^2]: wider than any sensor's, so that they are never unbounded.
constexpr double kBiasGyro = 0.2, kBiasAccel = 1.0;

ceres::Problem::Options without_manifolds() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

/// The start of a state's motion is known that well.
ceres::CostFunction* bias_prior() {
  ceres::Matrix information = ceres::Matrix::Zero(9, 9);
  information.diagonal().segment<3>(3).setConstant(1.0 / kBiasGyro);
  information.diagonal().tail<3>().setConstant(1.0 / kBiasAccel);
  return new ceres::NormalPrior(information, ceres::Vector::Zero(9));
}

using SparseMatrix = Eigen::SparseMatrix<double>;

SparseMatrix to_eigen(const ceres::CRSMatrix& J) {
  Eigen::SparseMatrix<double, Eigen::RowMajor> out(J.num_rows, J.num_cols);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(J.values.size());
  for (int row = 0; row < J.num_rows; ++row)
    for (int i = J.rows[static_cast<std::size_t>(row)]; i < J.rows[static_cast<std::size_t>(row) + 1]; ++i)
      entries.emplace_back(row, J.cols[static_cast<std::size_t>(i)], J.values[static_cast<std::size_t>(i)]);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// A column for each cluster of rows, so that J^T times it has the gradient of each cluster.
SparseMatrix by_cluster(const std::vector<double>& residuals, const std::vector<int>& rows) {
  SparseMatrix out(static_cast<Eigen::Index>(residuals.size()), static_cast<Eigen::Index>(rows.size()));
  int row = 0;
  for (std::size_t cluster = 0; cluster < rows.size(); ++cluster)
    for (int i = 0; i < rows[cluster]; ++i, ++row)
      out.insert(row, static_cast<Eigen::Index>(cluster)) = residuals[static_cast<std::size_t>(row)];
  return out;
}

/// The variances of the last columns of J, `kept` of them, with the others unknown as well: by J alone, or by the
/// gradients of the clusters where these scatter more.
Eigen::VectorXd marginal_variances(const SparseMatrix& J, const SparseMatrix& clusters, Eigen::Index kept) {
  const SparseMatrix H = J.transpose() * J;
  const Eigen::Index others = H.cols() - kept;
  const SparseMatrix gradients = J.transpose() * clusters;
  Eigen::MatrixXd information = H.bottomRightCorner(kept, kept).toDense();
  Eigen::MatrixXd scores = gradients.bottomRows(kept).toDense();
  if (others > 0) {
    SparseMatrix states = H.topLeftCorner(others, others);
    for (Eigen::Index i = 0; i < others; ++i) states.coeffRef(i, i) += 1e-9;
    const Eigen::MatrixXd coupling = H.topRightCorner(others, kept).toDense();
    const Eigen::MatrixXd eliminated = Eigen::SimplicialLDLT<SparseMatrix>(states).solve(coupling);
    information -= coupling.transpose() * eliminated;
    scores -= eliminated.transpose() * SparseMatrix(gradients.topRows(others));
  }
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() * scaled.ldlt().solve(Eigen::MatrixXd::Identity(kept, kept)) * scale.asDiagonal();
  return covariance.diagonal().cwiseMax((covariance * scores).rowwise().squaredNorm());
}

}  // namespace

RigProblem::RigProblem(RigUnknowns& unknowns, const std::vector<TargetCamera>& cameras, const TargetLayout& layout,
                       std::span<const ImuSample> imu, const ImuNoise& noise)
    : unknowns_(unknowns), has_imu_(!imu.empty()), problem_(without_manifolds()) {
  for (RigState& state : unknowns_.states) {
    problem_.AddParameterBlock(state.T_W_B.data(), 7, &pose_manifold_);
    problem_.AddParameterBlock(state.motion.data(), 9);
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    CameraBlocks& camera = unknowns_.cameras[i];
    problem_.AddParameterBlock(camera.T_B_C.data(), 7, &pose_manifold_);
    problem_.AddParameterBlock(&camera.correction_s, 1);
    std::vector<int> fixed(static_cast<std::size_t>(kLensParameters - cameras[i].lens.lens.count()));
    std::iota(fixed.begin(), fixed.end(), cameras[i].lens.lens.count());
    lens_manifolds_.emplace_back(kLensParameters, fixed);
    problem_.AddParameterBlock(camera.lens.data(), kLensParameters, fixed.empty() ? nullptr : &lens_manifolds_.back());
  }
  problem_.AddParameterBlock(unknowns_.tilt.data(), 2);
  add_views(cameras, layout);
  if (has_imu_) add_imu(imu, noise);
  fix_known_parameters(cameras);
}

void RigProblem::add_views(const std::vector<TargetCamera>& cameras, const TargetLayout& layout) {
  for (RigState& state : unknowns_.states) {
    rows_.push_back(0);
    for (const auto& [camera, view] : state.views) {
      CameraBlocks& blocks = unknowns_.cameras[camera];
      const TargetCamera& of = cameras[camera];
      const TargetView& seen = of.views.views[view];
      MovingReprojection::Instant instant;
      instant.after_state_s = to_seconds(seen.t + duration_from_seconds(blocks.time_offset_s) - state.t);
      instant.gyro_B = state.gyro_B;
      instant.R_W_T = unknowns_.R_W_T;
      auto* cost = new MovingReprojection(pairs_of(seen, layout), of.lens.lens.distortion, of.lens.sigma_px, instant);
      rows_.back() += cost->num_residuals();
      terms_.push_back(problem_.AddResidualBlock(cost, nullptr, state.T_W_B.data(), state.motion.data(),
                                                 blocks.T_B_C.data(), &blocks.correction_s, unknowns_.tilt.data(),
                                                 blocks.lens.data()));
    }
  }
}

void RigProblem::add_imu(std::span<const ImuSample> imu, const ImuNoise& noise) {
  problem_.AddParameterBlock(imu_intrinsics_.data(), 18);
  problem_.SetParameterBlockConstant(imu_intrinsics_.data());
  for (std::size_t i = 0; i + 1 < unknowns_.states.size(); ++i) {
    RigState &a = unknowns_.states[i], &b = unknowns_.states[i + 1];
    const Eigen::Map<const Eigen::Vector3d> bias_gyro(a.motion.data() + 3), bias_accel(a.motion.data() + 6);
    motions_.emplace_back(slice_imu(imu, a.t, b.t), bias_gyro, bias_accel, noise);
    imu_terms_.push_back(problem_.AddResidualBlock(new ImuFactor(i, i + 1, motions_.back()), nullptr, a.T_W_B.data(),
                                                   a.motion.data(), b.T_W_B.data(), b.motion.data(),
                                                   imu_intrinsics_.data()));
    terms_.push_back(imu_terms_.back());
    rows_.push_back(15);
  }
  terms_.push_back(problem_.AddResidualBlock(bias_prior(), nullptr, unknowns_.states.front().motion.data()));
  rows_.push_back(9);
}

void RigProblem::fix_known_parameters(const std::vector<TargetCamera>& cameras) {
  if (has_imu_) return;
  for (RigState& state : unknowns_.states) problem_.SetParameterBlockConstant(state.motion.data());
  for (std::size_t i = 0; i < cameras.size(); ++i)
    problem_.SetParameterBlockConstant(&unknowns_.cameras[i].correction_s);
  problem_.SetParameterBlockConstant(unknowns_.cameras.front().T_B_C.data());
  problem_.SetParameterBlockConstant(unknowns_.tilt.data());
}

void RigProblem::solve(int most_steps) {
  const ceres::Solver::Summary summary = solve_silently(problem_, ceres::SPARSE_NORMAL_CHOLESKY, most_steps, 1e-8);
  if (!summary.IsSolutionUsable())
    throw InputError::format("the optimization of the calibration fails ({}); record more, slower motion",
                             first_line(summary.message));
}

void RigProblem::apply_corrections() {
  for (CameraBlocks& camera : unknowns_.cameras) {
    camera.time_offset_s += camera.correction_s;
    camera.correction_s = 0.0;
  }
  unknowns_.R_W_T = so3::exp({unknowns_.tilt[0], unknowns_.tilt[1], 0.0}) * unknowns_.R_W_T;
  unknowns_.tilt = {};
}

Eigen::VectorXd RigProblem::calibration_variances() {
  std::vector<double*> order;
  const auto add = [&](double* block) {
    if (!problem_.IsParameterBlockConstant(block)) order.push_back(block);
  };
  for (RigState& state : unknowns_.states) add(state.T_W_B.data()), add(state.motion.data());
  add(unknowns_.tilt.data());
  // Of the calibration: where each column of the derivative belongs in the result.
  constexpr int kPerCamera = 7 + kLensParameters;
  std::vector<int> places;
  for (std::size_t i = 0; i < unknowns_.cameras.size(); ++i) {
    CameraBlocks& camera = unknowns_.cameras[i];
    int place = kPerCamera * static_cast<int>(i);
    for (double* block : {camera.T_B_C.data(), &camera.correction_s, camera.lens.data()}) {
      const bool estimated = !problem_.IsParameterBlockConstant(block);
      add(block);
      const int size = problem_.ParameterBlockTangentSize(block);
      for (int k = 0; k < size && estimated; ++k) places.push_back(place + k);
      place += size;
    }
  }
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = order;
  options.residual_blocks = terms_;
  std::vector<double> residuals;
  ceres::CRSMatrix J;
  problem_.Evaluate(options, nullptr, &residuals, nullptr, &J);
  const Eigen::VectorXd variances =
      marginal_variances(to_eigen(J), by_cluster(residuals, rows_), static_cast<Eigen::Index>(places.size()));
  Eigen::VectorXd out = Eigen::VectorXd::Zero(kPerCamera * static_cast<int>(unknowns_.cameras.size()));
  for (std::size_t i = 0; i < places.size(); ++i) out[places[i]] = variances[static_cast<Eigen::Index>(i)];
  return out;
}

double RigProblem::imu_misfit() const {
  double squares = 0.0;
  for (const ceres::ResidualBlockId term : imu_terms_) {
    double cost = 0.0;
    problem_.EvaluateResidualBlock(term, false, &cost, nullptr, nullptr);
    squares += 2.0 * cost;
  }
  return imu_terms_.empty() ? 0.0 : std::sqrt(squares / (15.0 * static_cast<double>(imu_terms_.size())));
}

}  // namespace edged
