// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/normal_equations.hpp"

#include <cmath>
#include <limits>

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
bool linearise(const Window& window, const Factor& factor, const Layout& layout, LinearFactor& out) {
  const std::size_t n = factor.blocks().size();
  const int rows = factor.num_residuals();
  std::vector<const double*> now(n);
  std::vector<RowMajorMatrix> J(n);
  std::vector<double*> J_data(n);
  out.blocks.clear();
  Index columns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const BlockKey& key = factor.blocks()[i];
    now[i] = window.block(key);
    J[i].resize(rows, block_size(key.kind));
    J_data[i] = J[i].data();
    out.blocks.push_back({columns, tangent_size(key.kind), layout.offset.at(key)});
    columns += tangent_size(key.kind);
  }
  out.r.resize(rows);
  if (!factor.Evaluate(now.data(), out.r.data(), J_data.data())) return false;
  double rho[3] = {0.0, 1.0, 0.0};
  if (factor.loss() != nullptr) factor.loss()->Evaluate(out.r.squaredNorm(), rho);
  const double weight = std::sqrt(rho[1]);
  out.r *= weight;
  out.J.resize(rows, columns);
  for (std::size_t i = 0; i < n; ++i) {
    const Placed& block = out.blocks[i];
    out.J.middleCols(block.local, block.size) = weight * J[i].leftCols(block.size);
  }
  return true;
}

/// The gradient of the window's prior.
struct PriorGradient {
  VectorXd g;
  std::vector<Placed> blocks;
  std::vector<std::pair<Index, Eigen::Matrix3d>> turns;  ///< first column of a rotation, its derivatives by a step
};

PriorGradient gradient_of(const Window& window, const LinearPrior& prior, const Layout& layout) {
  PriorGradient out;
  VectorXd d(prior.information.cols());
  Index column = 0;
  for (std::size_t i = 0; i < prior.blocks.size(); ++i) {
    const BlockKey& key = prior.blocks[i];
    const Index size = tangent_size(key.kind);
    const double* now = window.block(key);
    tangent_difference(key.kind, now, prior.x0[i].data(), d.data() + column);
    if (key.kind == BlockKind::Pose)
      out.turns.emplace_back(column + 3, so3::right_jacobian_inverse(d.segment<3>(column + 3)));
    out.blocks.push_back({column, size, layout.offset.at(key)});
    column += size;
  }
  out.g = prior.information * d + prior.J.transpose() * prior.r;
  for (const auto& [first, by_turn] : out.turns)
    out.g.segment<3>(first) = (by_turn.transpose() * out.g.segment<3>(first)).eval();
  return out;
}

/// The window's prior, whose J^T J is known: only rotations change its derivatives away from its linearization point.
void add_prior(const Window& window, const LinearPrior& prior, const Layout& layout, NormalEquations& equations) {
  const PriorGradient gradient = gradient_of(window, prior, layout);
  MatrixXd H = prior.information;
  for (const auto& [first, by_turn] : gradient.turns) {
    H.middleCols<3>(first) *= by_turn;
    H.middleRows<3>(first) = (by_turn.transpose() * H.middleRows<3>(first)).eval();
  }
  equations.add(H, gradient.g, gradient.blocks);
}

double value_of(const Window& window, const Factor& factor) {
  std::vector<const double*> now;
  for (const BlockKey& key : factor.blocks()) now.push_back(window.block(key));
  VectorXd r(factor.num_residuals());
  if (!factor.Evaluate(now.data(), r.data(), nullptr)) return std::numeric_limits<double>::infinity();
  double rho[3] = {r.squaredNorm(), 1.0, 0.0};
  if (factor.loss() != nullptr) factor.loss()->Evaluate(rho[0], rho);
  return 0.5 * rho[0];
}

}  // namespace

NormalEquations normal_equations(const Window& window, const Cost& cost, const Layout& layout,
                                 std::vector<DepthEquation>* eliminated, Purpose purpose) {
  NormalEquations equations(layout);
  LinearFactor linear;
  MatrixXd H;
  if (cost.prior) add_prior(window, cost.prior->prior(), layout, equations);
  for (const auto& factor : cost.factors) {
    if (!linearise(window, *factor, layout, linear)) continue;
    H.setZero(linear.J.cols(), linear.J.cols());
    H.selfadjointView<Eigen::Lower>().rankUpdate(linear.J.transpose());
    equations.add(H, linear.J.transpose() * linear.r, linear.blocks);
  }
  LandmarkEquations landmarks(window, layout, equations, purpose);
  for (const LandmarkTerm& term : cost.landmarks) landmarks.add(term, eliminated);
  return equations;
}

Eigen::VectorXd gradient(const Window& window, const Cost& cost, const Layout& layout,
                         std::vector<DepthEquation>& eliminated) {
  NormalEquations equations(layout.size);
  LinearFactor linear;
  if (cost.prior) {
    const PriorGradient prior = gradient_of(window, cost.prior->prior(), layout);
    equations.add_gradient(prior.g, prior.blocks);
  }
  for (const auto& factor : cost.factors) {
    if (!linearise(window, *factor, layout, linear)) continue;
    equations.add_gradient(linear.J.transpose() * linear.r, linear.blocks);
  }
  LandmarkEquations landmarks(window, layout, equations);
  auto depth = eliminated.begin();
  for (const LandmarkTerm& term : cost.landmarks) {
    const bool known = depth != eliminated.end() && depth->landmark == term.id;
    if (!term.residuals.empty()) landmarks.add_gradient(term, known ? &*depth : nullptr);
    if (known) ++depth;
  }
  return std::move(equations.g);
}

double value_of(const Window& window, const Cost& cost) {
  double sum = cost.prior ? value_of(window, *cost.prior) : 0.0;
  for (const auto& factor : cost.factors) sum += value_of(window, *factor);
  const CameraPoses views(window);
  for (const LandmarkTerm& term : cost.landmarks) sum += value_of(term, views, visual_loss());
  return sum;
}

}  // namespace edged
