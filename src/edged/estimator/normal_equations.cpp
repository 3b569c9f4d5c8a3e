// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/normal_equations.hpp"

#include "edged/estimator/cost.hpp"

namespace edged {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kNoInformation = 1e-9;  // a diagonal entry below this was not measured at all

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
  bool usable = factor.cost->Evaluate(first.data(), out.r.data(), J_data.data());
  if (now != first) usable = usable && factor.cost->Evaluate(now.data(), out.r.data(), nullptr);
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
    if (now[i] == first[i]) continue;
    VectorXd moved(tangent_size(kind));
    tangent_difference(kind, now[i], first[i], moved.data());
    out.r -= out.J.back() * moved;  // as a function of the distance from the first estimate
  }
  if (!usable) out.r.setZero();
  return out;
}

NormalEquations order_blocks(const std::vector<Factor>& factors, const std::set<BlockKey>& leaving) {
  NormalEquations eq;
  std::set<BlockKey> used;
  for (const Factor& factor : factors) used.insert(factor.blocks.begin(), factor.blocks.end());
  const auto place = [&](const BlockKey& key) {
    eq.offset[key] = eq.size;
    eq.size += tangent_size(key.kind);
  };
  const std::set<BlockKey> coupled = coupled_depths(factors);
  const auto alone = [&](const BlockKey& key) { return key.kind == BlockKind::InverseDepth && !coupled.contains(key); };
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
  std::vector<Eigen::Index> offsets;
  for (const BlockKey& key : factor.blocks) offsets.push_back(eq.offset.at(key));
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const MatrixXd& J_i = linear.J[i];
    eq.g.segment(offsets[i], J_i.cols()).noalias() += J_i.transpose().lazyProduct(linear.r);
    for (std::size_t j = 0; j < offsets.size(); ++j) {
      const MatrixXd& J_j = linear.J[j];
      eq.H.block(offsets[i], offsets[j], J_i.cols(), J_j.cols()).noalias() += J_i.transpose().lazyProduct(J_j);
    }
  }
}

/// These do not couple with one another: their part of H is diagonal.
void eliminate_depths(NormalEquations& eq) {
  const Eigen::Index m = eq.depths, n = eq.size - m;
  const VectorXd h = eq.H.diagonal().head(m);
  const VectorXd inverse = (h.array() > kNoInformation).select(h.array().inverse(), 0.0);
  const MatrixXd coupling = eq.H.bottomLeftCorner(n, m), scaled = coupling * inverse.asDiagonal();
  eq.H.bottomRightCorner(n, n).noalias() -= scaled * coupling.transpose();
  eq.g.tail(n).noalias() -= scaled * eq.g.head(m);
}

}  // namespace

Eigen::VectorXd unit_diagonal_scale(const MatrixXd& H) {
  return (H.diagonal().array() > kNoInformation).select(H.diagonal().array().rsqrt(), 0.0);
}

NormalEquations normal_equations(Window& window, const std::vector<Factor>& factors,
                                 const std::set<BlockKey>& leaving) {
  NormalEquations eq = order_blocks(factors, leaving);
  for (const Factor& factor : factors) accumulate(eq, factor, linearise(window, factor));
  eliminate_depths(eq);
  return eq;
}

}  // namespace edged
