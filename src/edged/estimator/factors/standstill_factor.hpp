// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The standstill factor: two states between which the body was at rest.
#pragma once

#include "edged/estimator/factors/factor.hpp"

namespace edged {

/// Blocks: pose a, pose b. Residual (6): (p_b - p_a) / position_sigma, Log(R_a^T R_b) / rotation_sigma. Zero velocity
/// updates alone let the position drift. The sigmas bound the motion during a detected standstill, whatever the time
/// between the two states. Two standstill factors around a dropped state merge.
class StandstillFactor final : public Factor {
 public:
  StandstillFactor(StateId a, StateId b) : Factor(6, {{BlockKind::Pose, a}, {BlockKind::Pose, b}}) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  std::shared_ptr<Factor> without(const DroppedState& dropped) const override;
};

}  // namespace edged
