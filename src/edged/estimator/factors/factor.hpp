// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the cost is a sum of, landmarks apart.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

/// What a term of the cost says. Prior: what has left the window; SoftPrior: set by hand.
enum class FactorKind : std::uint8_t { Prior, SoftPrior, Imu, Standstill, SceneDepth };

/// One term of the cost. When a keyframe leaves, all factors with a block of it go into the prior, but for what
/// `goes` (sliding.cpp) holds back: a kind that ties a keyframe to a state that is none must be held back there,
/// as that state is dropped later. What only a dropped state has measured is lost; IMU intervals and rest are joined
/// on.
struct Factor {
  FactorKind kind;
  std::unique_ptr<ceres::CostFunction> cost = nullptr;
  ceres::LossFunction* loss = nullptr;  ///< owned by the window
  std::vector<BlockKey> blocks = {};
  std::uint64_t state = 0;  ///< SceneDepth: the one whose image or events told it
  bool lasting = true;      ///< SceneDepth: its landmarks are all anchored in its state, and leave with it
};

}  // namespace edged
