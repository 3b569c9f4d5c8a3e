// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/covariance.hpp"

#include "edged/estimator/solver/envelope_cholesky.hpp"
#include "edged/estimator/solver/normal_equations.hpp"

namespace edged {

std::optional<Eigen::MatrixXd> covariance(const Window& window, const std::set<BlockKey>& blocks) {
  const Cost cost = cost_of(window);
  const std::set<BlockKey> all = blocks_of(cost);
  std::set<BlockKey> others = all;
  for (const BlockKey& block : blocks) {
    if (others.erase(block) == 0) return std::nullopt;
  }
  const Layout layout(all, others);
  const Eigen::MatrixXd H = normal_equations(window, cost, layout, nullptr, Purpose::Information).H.dense();
  const Eigen::Index m = layout.size - layout.leaving;
  const Eigen::VectorXd scale = unit_diagonal_scale(H.diagonal());
  EnvelopeCholesky cholesky;
  if (!cholesky.factorise(EnvelopeMatrix(scale.asDiagonal() * H * scale.asDiagonal()))) return std::nullopt;
  // The information of the blocks before the coupling to others.
  const Eigen::MatrixXd L = cholesky.last_of_L(m);
  const Eigen::MatrixXd root =
      L.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(m, m)) * scale.tail(m).asDiagonal();
  return root.transpose() * root;
}

std::optional<Matrix15d> covariance(const Window& window, StateId state) {
  const auto P = covariance(window, {{BlockKind::Pose, state}, {BlockKind::Motion, state}});
  return P ? std::optional<Matrix15d>(*P) : std::nullopt;
}

LogScale estimate_scale(const Window& window) {
  const BlockKey scale = *window.parameter(BlockKind::LogScale);
  const auto P = covariance(window, {scale});
  return {*window.block(scale), P ? std::sqrt((*P)(0, 0)) : window.depth_config().scale_sigma};
}

}  // namespace edged
