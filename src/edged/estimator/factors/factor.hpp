// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A term of the cost other than landmarks: its blocks, its loss, and its behaviour when a state leaves the window.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <algorithm>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

class Preintegration;

/// A state between two others that is dropped, without marginalization.
struct DroppedState {
  StateId before, id, after;
  const Preintegration& imu;       ///< from the state before to the one after; stays in the window
  const Preintegration& imu_into;  ///< from the state before to the one that leaves; does not stay
};

/// The values of the blocks are in the window; a factor holds the measurement.
class Factor : public ceres::CostFunction {
 public:
  const std::vector<BlockKey>& blocks() const { return blocks_; }
  /// Null: least squares.
  virtual const ceres::LossFunction* loss() const { return nullptr; }

  /// Whether it goes into the prior with the blocks that are marginalised. A factor between a keyframe and a state that
  /// is no keyframe must not: that state will be dropped.
  virtual bool marginalized_with(const std::set<BlockKey>& leaving) const {
    return std::ranges::any_of(blocks_, [&](const BlockKey& key) { return leaving.contains(key); });
  }
  /// The factor that replaces it when one of its states is dropped; null: it ends with that state.
  virtual std::shared_ptr<Factor> without(const DroppedState&) const { return nullptr; }
  /// Merges the measurement of another factor into this one; false if the two cannot be merged.
  virtual bool merge(const Factor&) { return false; }

  /// Replaces a block by another of the same kind.
  void replace(BlockKey before, BlockKey after) { std::ranges::replace(blocks_, before, after); }

 protected:
  Factor(int residuals, std::vector<BlockKey> blocks) : blocks_(std::move(blocks)) {
    set_num_residuals(residuals);
    for (const BlockKey& key : blocks_) mutable_parameter_block_sizes()->push_back(block_size(key.kind));
  }

 private:
  std::vector<BlockKey> blocks_;
};

}  // namespace edged
