// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver.hpp"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "edged/estimator/cost.hpp"

namespace edged {
namespace {

/// All blocks side by side in the order of their keys. Ceres orders blocks by address: only so are two runs bit-equal.
struct Arena {
  Arena(Window& window, const std::vector<Factor>& factors) {
    for (const Factor& factor : factors) {
      for (const BlockKey& key : factor.blocks) offsets.emplace(key, 0);
    }
    for (auto& [key, offset] : offsets) {
      offset = values.size();
      const double* block = window.block(key);
      values.insert(values.end(), block, block + block_size(key.kind));
    }
  }

  void write_back(Window& window) const {
    for (const auto& [key, offset] : offsets) {
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(offset), block_size(key.kind), window.block(key));
    }
  }

  std::map<BlockKey, std::size_t> offsets;
  std::vector<double> values;
};

}  // namespace

SolveSummary solve(Window& window, int max_iterations) {
  std::vector<Factor> factors = factors_of(window);
  PoseManifold pose_manifold;

  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  ceres::Problem problem(options);
  auto* ordering = new ceres::ParameterBlockOrdering;

  Arena arena(window, factors);
  const std::set<BlockKey> coupled = coupled_depths(factors);
  for (const auto& [key, offset] : arena.offsets) {
    double* block = arena.values.data() + offset;
    if (key.kind == BlockKind::Pose) {
      problem.AddParameterBlock(block, 7, &pose_manifold);
    } else {
      problem.AddParameterBlock(block, block_size(key.kind));
    }
    const bool alone = key.kind == BlockKind::InverseDepth && !coupled.contains(key);
    ordering->AddElementToGroup(block, alone ? 0 : 1);
  }
  std::vector<double*> blocks;
  for (const Factor& factor : factors) {
    blocks.clear();
    for (const BlockKey& key : factor.blocks) blocks.push_back(arena.values.data() + arena.offsets.at(key));
    problem.AddResidualBlock(factor.cost.get(), factor.loss, blocks.data(), static_cast<int>(blocks.size()));
  }

  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering.reset(ordering);
  solver.max_num_iterations = max_iterations;
  // Close to Gauss-Newton: the default damping leaves the scale, which many blocks share, far from converged.
  solver.initial_trust_region_radius = 1e9;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.function_tolerance = 1e-6;
  solver.gradient_tolerance = 0.0;
  solver.parameter_tolerance = 1e-7;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (summary.IsSolutionUsable()) arena.write_back(window);
  return {summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size()),
          summary.IsSolutionUsable()};
}

}  // namespace edged
