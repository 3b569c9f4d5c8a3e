// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the cost is a sum of.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

/// One term of the cost.
struct Factor {
  std::unique_ptr<ceres::CostFunction> cost;
  ceres::LossFunction* loss = nullptr;  ///< owned by the window
  std::vector<BlockKey> blocks;
};

}  // namespace edged
