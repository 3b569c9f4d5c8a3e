// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/covariance.hpp"

#include <Eigen/Cholesky>

#include "edged/estimator/normal_equations.hpp"

namespace edged {

std::optional<Matrix15d> covariance(Window& window, StateId state) {
  const std::vector<Factor> factors = window.factors();
  std::set<BlockKey> others;
  for (const Factor& factor : factors) others.insert(factor.blocks.begin(), factor.blocks.end());
  others.erase({BlockKind::Pose, state});
  others.erase({BlockKind::Motion, state});
  const NormalEquations eq = normal_equations(window, factors, others);
  const Eigen::Index n = eq.size - eq.depths;
  if (eq.size - eq.leaving != 15) return std::nullopt;
  const Eigen::MatrixXd H = eq.H.bottomRightCorner(n, n);
  const Eigen::VectorXd scale = unit_diagonal_scale(H);
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  if (llt.info() != Eigen::Success) return std::nullopt;
  // The last block of the factor is that of the Schur complement: the information that the state has of its own.
  const Matrix15d L = Matrix15d(llt.matrixLLT().bottomRightCorner<15, 15>().triangularView<Eigen::Lower>());
  const Matrix15d root = L.triangularView<Eigen::Lower>().solve(Matrix15d::Identity()) * scale.tail<15>().asDiagonal();
  return root.transpose() * root;
}

}  // namespace edged
