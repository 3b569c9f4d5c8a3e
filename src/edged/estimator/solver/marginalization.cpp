// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/marginalization.hpp"

#include <Eigen/Eigenvalues>

#include "edged/estimator/solver/normal_equations.hpp"

namespace edged {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRankTolerance = 1e-10;  // of a matrix with unit diagonal

/// Schur complement of the marginalized blocks, without directions that have no information.
void eliminate(Eigen::Index leaving, MatrixXd& H, VectorXd& g) {
  const Eigen::Index m = leaving, n = g.size() - m;
  if (m == 0) return;
  const MatrixXd H_mm = H.topLeftCorner(m, m).selfadjointView<Eigen::Lower>();
  const VectorXd scale = unit_diagonal_scale(H_mm.diagonal());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * H_mm * scale.asDiagonal());
  const VectorXd inverse =
      (eigen.eigenvalues().array() > kRankTolerance).select(eigen.eigenvalues().array().inverse(), 0.0);
  const MatrixXd V = scale.asDiagonal() * eigen.eigenvectors();
  const MatrixXd H_mm_inv = V * inverse.asDiagonal() * V.transpose();
  const MatrixXd H_nm = H.bottomLeftCorner(n, m);
  H.bottomRightCorner(n, n).noalias() -= H_nm * H_mm_inv * H_nm.transpose();
  g.tail(n).noalias() -= H_nm * (H_mm_inv * g.head(m));
}

struct Root {
  MatrixXd R;
  VectorXd r;
};

/// R^T R = H and R^T r = g, by Cholesky with the largest remaining pivot first, which reveals the rank: pivots of
/// rounding errors are about 1e-15. (Eigen's LDLT picks pivots from a diagonal that it does not keep up to date; behind
/// small ones they are noise of any size.)
Root root_of(MatrixXd H, VectorXd g) {
  const Eigen::Index n = g.size();
  Root root{MatrixXd(n, n), VectorXd(n)};
  Eigen::Index rank = 0, pivot = 0;
  for (; rank < n; ++rank) {
    const double largest = H.diagonal().maxCoeff(&pivot);
    if (!(largest > kRankTolerance)) break;
    const VectorXd row = H.col(pivot) / std::sqrt(largest);
    const double r = g[pivot] / std::sqrt(largest);
    H.noalias() -= row * row.transpose();
    g -= r * row;
    H.row(pivot).setZero(), H.col(pivot).setZero();
    root.R.row(rank) = row;
    root.r[rank] = r;
  }
  root.R.conservativeResize(rank, n);
  root.r.conservativeResize(rank);
  return root;
}

}  // namespace

LinearPrior marginalize(const Window& window, const Cost& cost, const std::set<BlockKey>& leaving) {
  std::set<BlockKey> all_leaving = leaving;
  for (const LandmarkTerm& term : cost.landmarks) all_leaving.insert({BlockKind::InverseDepth, term.id});
  const Layout layout(blocks_of(cost), all_leaving);
  NormalEquations equations = normal_equations(window, cost, layout, nullptr, Purpose::Information);
  MatrixXd all = equations.H.dense();
  eliminate(layout.leaving, all, equations.g);

  LinearPrior prior;
  const Eigen::Index n = layout.size - layout.leaving;
  if (n == 0) return prior;
  const MatrixXd H = all.bottomRightCorner(n, n).selfadjointView<Eigen::Lower>();
  const VectorXd scale = unit_diagonal_scale(H.diagonal());
  const VectorXd inverse_scale = (scale.array() > 0.0).select(scale.array().inverse(), 0.0);
  const Root root = root_of(scale.asDiagonal() * H * scale.asDiagonal(), scale.asDiagonal() * equations.g.tail(n));
  prior.J = root.R * inverse_scale.asDiagonal();
  prior.r = root.r;
  prior.information = prior.J.transpose() * prior.J;
  prior.blocks = layout.staying;
  for (const BlockKey& key : prior.blocks) {
    const double* x0 = window.block(key);
    prior.x0.emplace_back(x0, x0 + block_size(key.kind));
  }
  return prior;
}

}  // namespace edged
