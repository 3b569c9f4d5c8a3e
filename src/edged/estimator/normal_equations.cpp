// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/normal_equations.hpp"

#include <cmath>
#include <limits>

#include "edged/estimator/landmark_equations.hpp"

namespace edged {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A factor's residual and Jacobian by the tangents of its blocks side by side.
struct LinearFactor {
  VectorXd r;
  MatrixXd J;
  std::vector<Placed> blocks;
};

/// False where the factor is not defined at the present values.
bool linearise(Window& window, const Factor& factor, const Layout& layout, Linearisation at, LinearFactor& out) {
  const std::size_t n = factor.blocks.size();
  const int rows = factor.cost->num_residuals();
  std::vector<const double*> now(n), taken(n);
  std::vector<RowMajorMatrix> J(n);
  std::vector<double*> J_data(n);
  out.blocks.clear();
  Index columns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const BlockKey& key = factor.blocks[i];
    now[i] = window.block(key);
    taken[i] = at == Linearisation::Present ? now[i] : window.linearisation_point(key);
    J[i].resize(rows, block_size(key.kind));
    J_data[i] = J[i].data();
    out.blocks.push_back({columns, tangent_size(key.kind), layout.offset.at(key)});
    columns += tangent_size(key.kind);
  }
  out.r.resize(rows);
  if (!factor.cost->Evaluate(taken.data(), out.r.data(), J_data.data())) return false;
  if (now != taken && !factor.cost->Evaluate(now.data(), out.r.data(), nullptr)) return false;
  double rho[3] = {0.0, 1.0, 0.0};
  if (factor.loss != nullptr) factor.loss->Evaluate(out.r.squaredNorm(), rho);
  const double weight = std::sqrt(rho[1]);
  out.r *= weight;
  out.J.resize(rows, columns);
  for (std::size_t i = 0; i < n; ++i) {
    const Placed& block = out.blocks[i];
    out.J.middleCols(block.local, block.size) = weight * J[i].leftCols(block.size);
    if (now[i] == taken[i]) continue;
    VectorXd moved(block.size);
    tangent_difference(factor.blocks[i].kind, now[i], taken[i], moved.data());
    out.r -= out.J.middleCols(block.local, block.size) * moved;
  }
  return true;
}

double value_of(Window& window, const Factor& factor) {
  std::vector<const double*> now;
  for (const BlockKey& key : factor.blocks) now.push_back(window.block(key));
  VectorXd r(factor.cost->num_residuals());
  if (!factor.cost->Evaluate(now.data(), r.data(), nullptr)) return std::numeric_limits<double>::infinity();
  double rho[3] = {r.squaredNorm(), 1.0, 0.0};
  if (factor.loss != nullptr) factor.loss->Evaluate(rho[0], rho);
  return 0.5 * rho[0];
}

}  // namespace

NormalEquations normal_equations(Window& window, const Cost& cost, const Layout& layout, Linearisation at,
                                 std::vector<EliminatedDepth>* eliminated) {
  NormalEquations equations(layout.size);
  LinearFactor linear;
  MatrixXd H;
  for (const Factor& factor : cost.factors) {
    if (!linearise(window, factor, layout, at, linear)) continue;
    H.setZero(linear.J.cols(), linear.J.cols());
    H.selfadjointView<Eigen::Lower>().rankUpdate(linear.J.transpose());
    equations.add(H, linear.J.transpose() * linear.r, linear.blocks);
  }
  LandmarkEquations landmarks(window, layout, at);
  for (const LandmarkTerm& term : cost.landmarks) landmarks.add(term, equations, eliminated);
  return equations;
}

double value_of(Window& window, const Cost& cost) {
  double sum = 0.0;
  for (const Factor& factor : cost.factors) sum += value_of(window, factor);
  const CameraViews views(window);
  for (const LandmarkTerm& term : cost.landmarks) sum += value_of(term, views, *window.visual_loss());
  return sum;
}

}  // namespace edged
