// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/marginalization.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "edged/estimator/normal_equations.hpp"

namespace edged {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRankTolerance = 1e-10;  // of a matrix with unit diagonal

/// Schur complement of the leaving blocks, with the directions nothing has measured left out.
void eliminate(Eigen::Index leaving, NormalEquations& eq) {
  const Eigen::Index m = leaving, n = eq.g.size() - m;
  if (m == 0) return;
  const MatrixXd H_mm = eq.H.topLeftCorner(m, m).selfadjointView<Eigen::Lower>();
  const VectorXd scale = unit_diagonal_scale(H_mm);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * H_mm * scale.asDiagonal());
  const VectorXd inverse =
      (eigen.eigenvalues().array() > kRankTolerance).select(eigen.eigenvalues().array().inverse(), 0.0);
  const MatrixXd V = scale.asDiagonal() * eigen.eigenvectors();
  const MatrixXd H_mm_inv = V * inverse.asDiagonal() * V.transpose();
  const MatrixXd H_nm = eq.H.bottomLeftCorner(n, m);
  eq.H.bottomRightCorner(n, n).noalias() -= H_nm * H_mm_inv * H_nm.transpose();
  eq.g.tail(n).noalias() -= H_nm * (H_mm_inv * eq.g.head(m));
}

}  // namespace

LinearPrior marginalize(const Window& window, const Cost& cost, const std::set<BlockKey>& leaving) {
  std::set<BlockKey> all_leaving = leaving;
  for (const LandmarkTerm& term : cost.landmarks) all_leaving.insert({BlockKind::InverseDepth, term.id});
  const Layout layout(blocks_of(cost), all_leaving);
  NormalEquations eq = normal_equations(window, cost, layout, Linearisation::FirstEstimates);
  eliminate(layout.leaving, eq);

  LinearPrior prior;
  const Eigen::Index n = layout.size - layout.leaving;
  if (n == 0) return prior;
  const MatrixXd H = eq.H.bottomRightCorner(n, n).selfadjointView<Eigen::Lower>();
  const VectorXd scale = unit_diagonal_scale(H);
  // S H S = P^T L D L^T P: the rows of D^(1/2) L^T P S^-1, those with no information left out.
  const Eigen::LDLT<MatrixXd> ldlt(scale.asDiagonal() * H * scale.asDiagonal());
  const VectorXd D = ldlt.vectorD();
  const VectorXd inverse_scale = (scale.array() > 0.0).select(scale.array().inverse(), 0.0);
  const MatrixXd P = ldlt.transpositionsP() * MatrixXd::Identity(n, n);
  const MatrixXd L_T_P = ldlt.matrixU() * P;
  const VectorXd g = scale.asDiagonal() * eq.g.tail(n);
  const VectorXd y = ldlt.matrixL().solve(P * g);  // L^-1 P S g
  const Eigen::Index rows = (D.array() > kRankTolerance).count();
  prior.J.resize(rows, n);
  prior.r.resize(rows);
  for (Eigen::Index i = 0, row = 0; i < n; ++i) {
    if (!(D[i] > kRankTolerance)) continue;
    prior.J.row(row) = std::sqrt(D[i]) * L_T_P.row(i) * inverse_scale.asDiagonal();
    prior.r[row++] = y[i] / std::sqrt(D[i]);
  }
  prior.information = prior.J.transpose() * prior.J;
  prior.blocks = layout.staying;
  for (const BlockKey& key : prior.blocks) {
    const double* x0 = window.linearisation_point(key);
    prior.x0.emplace_back(x0, x0 + block_size(key.kind));
  }
  return prior;
}

}  // namespace edged
