// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Solves the window with Ceres.
#pragma once

#include "edged/estimator/window.hpp"

namespace edged {

struct SolveSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;
  bool usable = false;
};

/// Minimises the sum of the window's factors over all its blocks, in place. One thread; deterministic.
SolveSummary solve(Window& window, int max_iterations);

}  // namespace edged
