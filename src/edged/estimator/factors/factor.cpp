// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/factor.hpp"

#include <algorithm>

namespace edged {

Factor::Factor(int residuals, std::vector<BlockKey> blocks) : blocks_(std::move(blocks)) {
  set_num_residuals(residuals);
  for (const BlockKey& key : blocks_) mutable_parameter_block_sizes()->push_back(block_size(key.kind));
}

bool Factor::marginalized_with(const std::set<BlockKey>& leaving) const {
  return std::ranges::any_of(blocks_, [&](const BlockKey& key) { return leaving.contains(key); });
}

std::shared_ptr<Factor> Factor::without(const DroppedState&) const { return nullptr; }

bool Factor::absorb(const Factor&) { return false; }

void Factor::replace(BlockKey before, BlockKey after) { std::ranges::replace(blocks_, before, after); }

}  // namespace edged
