// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Solves the window: Gauss-Newton with inverse depths eliminated, damped if a step does not decrease the cost.
#pragma once

#include <functional>

#include "edged/estimator/window/window.hpp"

namespace edged {

struct SolveSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;   ///< steps tried
  bool usable = false;  ///< the cost is defined at the present values
};

/// Minimises the sum of the window's terms over all its blocks, in place. One thread; deterministic.
SolveSummary solve(Window& window, int max_iterations);
/// Solves a window of any length as solve() does, in time and memory that grow with its length (banded_layout).
/// progress: called after each step with its share of max_iterations.
SolveSummary solve_long(Window& window, int max_iterations, const std::function<void(double)>& progress = {});

}  // namespace edged
