// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The call of Ceres that the fits of one lens and of the whole rig share.
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace edged {

/// Optimizes with these choices and the library's defaults; prints nothing.
inline ceres::Solver::Summary solve_silently(ceres::Problem& problem, ceres::LinearSolverType solver, int most_steps,
                                             double function_tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = solver;
  options.max_num_iterations = most_steps;
  options.function_tolerance = function_tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

}  // namespace edged
