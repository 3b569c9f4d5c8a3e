// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver.hpp"

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace edged {

SolveSummary solve(Window& window, int max_iterations) {
  std::vector<Factor> factors = window.factors();
  PoseManifold pose_manifold;

  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  ceres::Problem problem(options);
  auto* ordering = new ceres::ParameterBlockOrdering;

  std::vector<double*> blocks;
  for (const Factor& factor : factors) {
    blocks.clear();
    for (const BlockKey& key : factor.blocks) {
      double* block = window.block(key);
      blocks.push_back(block);
      if (problem.HasParameterBlock(block)) continue;
      if (key.kind == BlockKind::Pose) {
        problem.AddParameterBlock(block, 7, &pose_manifold);
      } else {
        problem.AddParameterBlock(block, block_size(key.kind));
      }
      ordering->AddElementToGroup(block, key.kind == BlockKind::InverseDepth ? 0 : 1);
    }
    problem.AddResidualBlock(factor.cost.get(), factor.loss, blocks.data(), static_cast<int>(blocks.size()));
  }

  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering.reset(ordering);
  solver.max_num_iterations = max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.function_tolerance = 1e-4;
  solver.gradient_tolerance = 0.0;
  solver.parameter_tolerance = 1e-7;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return {summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size()),
          summary.IsSolutionUsable()};
}

}  // namespace edged
