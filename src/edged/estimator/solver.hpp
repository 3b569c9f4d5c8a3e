// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Solves the window: Gauss-Newton, the inverse depths eliminated, damped where a step does not gain.
#pragma once

#include "edged/estimator/window.hpp"

namespace edged {

struct SolveSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;   ///< steps tried
  bool usable = false;  ///< the cost is defined where the window stands
};

/// Minimises the sum of the window's terms over all its blocks, in place. One thread; deterministic.
SolveSummary solve(Window& window, int max_iterations);

}  // namespace edged
