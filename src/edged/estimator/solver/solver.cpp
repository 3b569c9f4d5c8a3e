// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "edged/estimator/solver/banded_layout.hpp"
#include "edged/estimator/solver/envelope_cholesky.hpp"
#include "edged/estimator/solver/normal_equations.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

using Eigen::VectorXd;

/// What of the linear system is that of the present values.
enum class Current { All, Gradient, Nothing };

/// The linear system of the window near its present values, with steps and their undo.
class Neighbourhood {
 public:
  Neighbourhood(Window& window, const Cost& cost, Layout layout)
      : window_(window), cost_(cost), layout_(std::move(layout)) {}

  /// Moves the window by a step if that decreases the cost, and returns the cost after the step: infinite if there is
  /// none.
  double try_step(Current current, double damping, double cost_before) {
    if (current == Current::Nothing) linearise();
    if (current != Current::Gradient && !cholesky_.factorise(H_, damping))
      return std::numeric_limits<double>::infinity();
    const VectorXd d = scale_.asDiagonal() * cholesky_.solve(-g_);
    if (!d.allFinite()) return std::numeric_limits<double>::infinity();
    const std::vector<double> before = window_.estimates();
    move(d);
    const double cost = value_of(window_, cost_);
    if (!(cost < cost_before)) window_.restore(before);
    return cost;
  }

  /// Updates the gradient to the present values; the matrix stays that of the last linearization.
  void update_gradient() { g_ = scale_.asDiagonal() * gradient(window_, cost_, layout_, eliminated_); }

 private:
  void linearise() {
    eliminated_.clear();
    NormalEquations equations = normal_equations(window_, cost_, layout_, &eliminated_);
    scale_ = unit_diagonal_scale(equations.H.diagonal());
    H_ = std::move(equations.H);
    H_.scale(scale_);
    g_ = scale_.asDiagonal() * equations.g;
  }

  void move(const VectorXd& d) {
    for (const auto& [key, offset] : layout_.offset) {
      window_.move(key, {d.data() + offset, static_cast<std::size_t>(tangent_size(key.kind))});
    }
    for (const DepthEquation& depth : eliminated_) {
      double coupled = depth.g;
      for (const DepthByCalibration& camera : depth.calibrations) {
        coupled += camera.coupling.dot(d.segment<kCalibrationSize>(camera.global));
      }
      for (const DepthByPose& pose : depth.poses) coupled += pose.coupling.dot(d.segment<6>(pose.global));
      const double step = -coupled / depth.h;
      window_.move({BlockKind::InverseDepth, depth.landmark}, {&step, 1});
    }
  }

  Window& window_;
  const Cost& cost_;
  Layout layout_;
  std::vector<DepthEquation> eliminated_;
  VectorXd scale_, g_;
  EnvelopeMatrix H_;
  EnvelopeCholesky cholesky_;
};

SolveSummary solve(Window& window, const Cost& cost, Layout layout, int max_iterations,
                   const std::function<void(double)>& progress = {}) {
  SolveSummary summary;
  summary.initial_cost = summary.final_cost = value_of(window, cost);
  summary.usable = std::isfinite(summary.initial_cost);
  if (!summary.usable) return summary;
  Neighbourhood around(window, cost, std::move(layout));
  double damping = kSolverTuning.damping;
  Current current = Current::Nothing;
  while (summary.iterations < max_iterations) {
    ++summary.iterations;
    const double value = around.try_step(current, damping, summary.final_cost);
    if (progress) progress(static_cast<double>(summary.iterations) / max_iterations);
    if (value < summary.final_cost) {
      const double gain = summary.final_cost - value;
      summary.final_cost = value;
      const bool of_new_matrix = current != Current::Gradient;
      if (of_new_matrix && gain <= kSolverTuning.converged * value) break;
      // After a small decrease the matrix is as good as new: the next step is by the same factorization, with a new
      // gradient (the simplified Newton method).
      const bool undamped = damping == kSolverTuning.damping;
      const bool keep_matrix = of_new_matrix && undamped && gain < kSolverTuning.keep_matrix * value;
      current = keep_matrix ? Current::Gradient : Current::Nothing;
      if (keep_matrix) around.update_gradient();
      damping = kSolverTuning.damping;
    } else if (current == Current::Gradient) {
      current = Current::Nothing;  // the matrix is too old
      --summary.iterations;
    } else {
      if (std::isfinite(value) && value - summary.final_cost <= kSolverTuning.converged * value) break;  // converged
      current = Current::All;
      damping *= kSolverTuning.damping_factor;
    }
  }
  return summary;
}

}  // namespace

SolveSummary solve(Window& window, int max_iterations) {
  const Cost cost = cost_of(window);
  const std::set<BlockKey> blocks = blocks_of(cost);
  return solve(window, cost, Layout(blocks, blocks), max_iterations);
}

SolveSummary solve_long(Window& window, int max_iterations, const std::function<void(double)>& progress) {
  const Cost cost = cost_of(window);
  return solve(window, cost, banded_layout(window, cost), max_iterations, progress);
}

}  // namespace edged
