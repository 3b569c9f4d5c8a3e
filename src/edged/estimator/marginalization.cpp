// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/marginalization.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <map>

namespace edged {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kNoInformation = 1e-9;   // a diagonal entry below this was not measured at all
constexpr double kRankTolerance = 1e-10;  // of a matrix with unit diagonal

/// A factor's residual r and Jacobian columns J per block, so that r + sum J_i * (x_i - x0_i) is its linear form.
struct LinearFactor {
  VectorXd r;
  std::vector<MatrixXd> J;
};

LinearFactor linearise(Window& window, const Factor& factor) {
  const int rows = factor.cost->num_residuals();
  const std::size_t n = factor.blocks.size();
  std::vector<const double*> now(n), first(n);
  std::vector<RowMajorMatrix> J(n);
  std::vector<double*> J_data(n);
  for (std::size_t i = 0; i < n; ++i) {
    now[i] = window.block(factor.blocks[i]);
    first[i] = window.linearisation_point(factor.blocks[i]);
    J[i].resize(rows, block_size(factor.blocks[i].kind));
    J_data[i] = J[i].data();
  }
  LinearFactor out;
  out.r.resize(rows);
  VectorXd unused(rows);
  const bool usable = factor.cost->Evaluate(now.data(), out.r.data(), nullptr) &&
                      factor.cost->Evaluate(first.data(), unused.data(), J_data.data());
  double weight = usable ? 1.0 : 0.0;
  if (usable && factor.loss != nullptr) {
    double rho[3];
    factor.loss->Evaluate(out.r.squaredNorm(), rho);
    weight = std::sqrt(rho[1]);
  }
  out.r *= weight;
  for (std::size_t i = 0; i < n; ++i) {
    const BlockKind kind = factor.blocks[i].kind;
    out.J.push_back(weight == 0.0 ? MatrixXd::Zero(rows, tangent_size(kind))
                                  : MatrixXd(weight * J[i].leftCols(tangent_size(kind))));
    VectorXd moved(tangent_size(kind));
    tangent_difference(kind, now[i], first[i], moved.data());
    out.r -= out.J.back() * moved;  // as a function of the distance from the first estimate
  }
  if (!usable) out.r.setZero();
  return out;
}

/// The normal equations H d = -g of all factors, ordered: leaving inverse depths that do not couple, other leaving
/// blocks, staying blocks.
struct NormalEquations {
  std::map<BlockKey, Eigen::Index> offset;
  std::vector<BlockKey> staying;
  Eigen::Index depths = 0, leaving = 0, size = 0;
  MatrixXd H;
  VectorXd g;
};

NormalEquations order_blocks(const std::vector<Factor>& factors, const std::set<BlockKey>& leaving) {
  NormalEquations eq;
  std::set<BlockKey> used;
  for (const Factor& factor : factors) used.insert(factor.blocks.begin(), factor.blocks.end());
  const auto place = [&](const BlockKey& key) {
    eq.offset[key] = eq.size;
    eq.size += tangent_size(key.kind);
  };
  const std::set<BlockKey> coupled = coupled_depths(factors);
  const auto alone = [&](const BlockKey& key) {
    return key.kind == BlockKind::InverseDepth && !coupled.contains(key);
  };
  for (const BlockKey& key : used) {
    if (leaving.contains(key) && alone(key)) place(key);
  }
  eq.depths = eq.size;
  for (const BlockKey& key : used) {
    if (leaving.contains(key) && !alone(key)) place(key);
  }
  eq.leaving = eq.size;
  for (const BlockKey& key : used) {
    if (!leaving.contains(key)) place(key), eq.staying.push_back(key);
  }
  eq.H = MatrixXd::Zero(eq.size, eq.size);
  eq.g = VectorXd::Zero(eq.size);
  return eq;
}

void accumulate(NormalEquations& eq, const Factor& factor, const LinearFactor& linear) {
  for (std::size_t i = 0; i < factor.blocks.size(); ++i) {
    const Eigen::Index row = eq.offset.at(factor.blocks[i]);
    eq.g.segment(row, linear.J[i].cols()).noalias() += linear.J[i].transpose() * linear.r;
    for (std::size_t j = 0; j < factor.blocks.size(); ++j) {
      eq.H.block(row, eq.offset.at(factor.blocks[j]), linear.J[i].cols(), linear.J[j].cols()).noalias() +=
          linear.J[i].transpose() * linear.J[j];
    }
  }
}

/// These do not couple with one another: each is one rank-one update.
void eliminate_depths(NormalEquations& eq) {
  const Eigen::Index n = eq.size - eq.depths;
  for (Eigen::Index i = 0; i < eq.depths; ++i) {
    const double h = eq.H(i, i);
    if (h < kNoInformation) continue;
    const VectorXd column = eq.H.block(eq.depths, i, n, 1);
    eq.H.bottomRightCorner(n, n).noalias() -= column * (column.transpose() / h);
    eq.g.tail(n) -= column * (eq.g[i] / h);
  }
}

/// S with ones on the diagonal of S H S: positions, angles and biases differ in information by ten orders of magnitude.
VectorXd unit_diagonal_scale(const MatrixXd& H) {
  return (H.diagonal().array() > kNoInformation).select(H.diagonal().array().rsqrt(), 0.0);
}

/// Schur complement of the other leaving blocks, with the directions nothing has measured left out.
void eliminate_states(NormalEquations& eq) {
  const Eigen::Index m = eq.leaving - eq.depths, n = eq.size - eq.leaving;
  if (m == 0) return;
  const MatrixXd H_mm = eq.H.block(eq.depths, eq.depths, m, m);
  const VectorXd scale = unit_diagonal_scale(H_mm);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * H_mm * scale.asDiagonal());
  const VectorXd inverse =
      (eigen.eigenvalues().array() > kRankTolerance).select(eigen.eigenvalues().array().inverse(), 0.0);
  const MatrixXd V = scale.asDiagonal() * eigen.eigenvectors();
  const MatrixXd H_mm_inv = V * inverse.asDiagonal() * V.transpose();
  const MatrixXd H_nm = eq.H.block(eq.leaving, eq.depths, n, m);
  eq.H.bottomRightCorner(n, n).noalias() -= H_nm * H_mm_inv * H_nm.transpose();
  eq.g.tail(n).noalias() -= H_nm * (H_mm_inv * eq.g.segment(eq.depths, m));
}

}  // namespace

LinearPrior marginalize(Window& window, const std::vector<Factor>& factors, const std::set<BlockKey>& leaving) {
  NormalEquations eq = order_blocks(factors, leaving);
  for (const Factor& factor : factors) accumulate(eq, factor, linearise(window, factor));
  eliminate_depths(eq);
  eliminate_states(eq);

  LinearPrior prior;
  const Eigen::Index n = eq.size - eq.leaving;
  if (n == 0) return prior;
  const MatrixXd H = 0.5 * (eq.H.bottomRightCorner(n, n) + MatrixXd(eq.H.bottomRightCorner(n, n).transpose()));
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
  prior.blocks = eq.staying;
  for (const BlockKey& key : prior.blocks) {
    const double* x0 = window.linearisation_point(key);
    prior.x0.emplace_back(x0, x0 + block_size(key.kind));
  }
  return prior;
}

}  // namespace edged
