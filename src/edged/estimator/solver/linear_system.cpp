// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/linear_system.hpp"

namespace edged {

Layout::Layout(const std::set<BlockKey>& blocks, const std::set<BlockKey>& going) {
  const auto place = [&](const BlockKey& key) {
    offset.emplace(key, size);
    size += tangent_size(key.kind);
  };
  for (const bool motions : {true, false}) {
    for (const BlockKey& key : blocks) {
      if (going.contains(key) && (key.kind == BlockKind::Motion) == motions) place(key);
    }
  }
  leaving = size;
  for (const BlockKey& key : blocks) {
    if (!going.contains(key)) place(key), staying.push_back(key);
  }
  envelope = {{size, 0}};
}

Layout::Layout(std::span<const BlockKey> order) {
  for (const BlockKey& key : order) {
    offset.emplace(key, size);
    size += tangent_size(key.kind);
  }
  leaving = size;
  envelope = {{size, 0}};
}

void NormalEquations::add(const Eigen::Ref<const Eigen::MatrixXd>& term_H,
                          const Eigen::Ref<const Eigen::VectorXd>& term_g, std::span<const Placed> blocks) {
  add_gradient(term_g, blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Placed& row = blocks[i];
    for (std::size_t j = 0; j <= i; ++j) {
      const Placed& column = blocks[j];
      add(row.global, column.global, term_H.block(row.local, column.local, row.size, column.size));
    }
  }
}

void NormalEquations::add_gradient(const Eigen::Ref<const Eigen::VectorXd>& term_g, std::span<const Placed> blocks) {
  for (const Placed& block : blocks) g.segment(block.global, block.size) += term_g.segment(block.local, block.size);
}

Eigen::VectorXd unit_diagonal_scale(const Eigen::VectorXd& diagonal_of_H) {
  return (diagonal_of_H.array() > kNoInformation).select(diagonal_of_H.array().rsqrt(), 0.0);
}

}  // namespace edged
