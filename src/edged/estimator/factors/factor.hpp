// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A term of the cost, landmarks apart: its blocks, its loss, and what becomes of it when a state leaves the window.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <memory>
#include <set>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

class Preintegration;

/// A state that leaves from between two others, without being marginalised.
struct DroppedState {
  StateId before, id, after;
  const Preintegration& imu;       ///< from the state before to that after; stays in the window
  const Preintegration& imu_into;  ///< from the state before to the one that leaves; does not stay
};

/// The values of the blocks are in the window; a factor holds the measurement.
class Factor : public ceres::CostFunction {
 public:
  const std::vector<BlockKey>& blocks() const { return blocks_; }
  /// Null: least squares.
  virtual const ceres::LossFunction* loss() const { return nullptr; }

  /// Whether it goes into the prior with the blocks that are marginalised. A factor that ties a keyframe to a state
  /// that is none must not: that state will be dropped.
  virtual bool marginalized_with(const std::set<BlockKey>& leaving) const;
  /// What it becomes when a state that it is of is dropped; null: it ends with that state.
  virtual std::shared_ptr<Factor> without(const DroppedState& dropped) const;
  /// Takes in the measurement of another factor, which then is not needed; false where the two cannot be one.
  virtual bool absorb(const Factor& other);

  /// One block takes the place of another of the same kind.
  void replace(BlockKey before, BlockKey after);

 protected:
  Factor(int residuals, std::vector<BlockKey> blocks);

 private:
  std::vector<BlockKey> blocks_;
};

}  // namespace edged
