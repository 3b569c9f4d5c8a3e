// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The standstill factor: two states between which the body rested.
#pragma once

#include <ceres/sized_cost_function.h>

namespace edged {

/// Blocks: pose a, pose b. Residual (6): (p_b - p_a) / position_sigma, Log(R_a^T R_b) / rotation_sigma. Velocity
/// updates alone let the position walk away: they say how slow, not that it comes to nothing.
class StandstillFactor final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  /// Sigmas in [m] and [rad].
  StandstillFactor(double position_sigma, double rotation_sigma)
      : position_weight_(1.0 / position_sigma), rotation_weight_(1.0 / rotation_sigma) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  double position_weight_, rotation_weight_;
};

}  // namespace edged
