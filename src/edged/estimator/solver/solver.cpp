// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/estimator/solver/envelope_cholesky.hpp"
#include "edged/estimator/solver/normal_equations.hpp"

namespace edged {
namespace {

using Eigen::VectorXd;

// Of a matrix with ones on its diagonal. Close to Gauss-Newton: with more damping the scale, common to many blocks,
// does not converge.
constexpr double kDamping = 1e-9, kMoreDamping = 1e3;
constexpr double kConverged = 1e-6;  // a step with a smaller relative decrease of the cost is the last

// After a step that decreases the cost by less than this share the matrix is as good as new: the next step is by the
// same factorization, with a new gradient (the simplified Newton method).
constexpr double kSmall = 0.1;

/// What of the linear system is that of the present values.
enum class Current { All, Gradient, Nothing };

/// The linear system of the window near its present values, with steps and their undo.
class Neighbourhood {
 public:
  Neighbourhood(Window& window, const Cost& cost)
      : window_(window), cost_(cost), layout_(blocks_of(cost), blocks_of(cost)) {}

  void linearise() {
    eliminated_.clear();
    NormalEquations equations = normal_equations(window_, cost_, layout_, Linearisation::Present, &eliminated_);
    scale_ = unit_diagonal_scale(equations.H);
    H_ = std::move(equations.H);
    H_.array() *= (scale_ * scale_.transpose()).array();
    g_ = scale_.asDiagonal() * equations.g;
  }

  /// The gradient at the present values; the matrix stays that of linearise().
  void update_gradient() { g_ = scale_.asDiagonal() * gradient(window_, cost_, layout_, eliminated_); }

  /// False if the system has no solution.
  bool factorise(double damping) { return cholesky_.factorise(H_, damping); }

  /// The step that solves the system; false if it is not finite.
  bool step(VectorXd& d) const {
    d = scale_.asDiagonal() * cholesky_.solve(-g_);
    return d.allFinite();
  }

  /// Moves the window; restore() undoes it.
  void move(const VectorXd& d) {
    before_ = window_.estimates();
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

  void restore() { window_.restore(before_); }

 private:
  Window& window_;
  const Cost& cost_;
  Layout layout_;
  std::vector<DepthEquation> eliminated_;
  VectorXd scale_, g_;
  Eigen::MatrixXd H_;
  EnvelopeCholesky cholesky_;
  std::vector<double> before_;
};

}  // namespace

SolveSummary solve(Window& window, int max_iterations) {
  const Cost cost = cost_of(window);
  SolveSummary summary;
  summary.initial_cost = summary.final_cost = value_of(window, cost);
  summary.usable = std::isfinite(summary.initial_cost);
  if (!summary.usable) return summary;
  Neighbourhood around(window, cost);
  VectorXd d;
  double damping = kDamping;
  Current current = Current::Nothing;
  while (summary.iterations < max_iterations) {
    ++summary.iterations;
    if (current == Current::Nothing) around.linearise();
    double value = std::numeric_limits<double>::infinity();
    if ((current == Current::Gradient || around.factorise(damping)) && around.step(d)) {
      around.move(d);
      value = value_of(window, cost);
      if (!(value < summary.final_cost)) around.restore();
    }
    if (!(value < summary.final_cost)) {
      if (current == Current::Gradient) {
        current = Current::Nothing;  // the matrix is too old
        --summary.iterations;
        continue;
      }
      if (std::isfinite(value) && value - summary.final_cost <= kConverged * value) break;  // converged
      current = Current::All;
      damping *= kMoreDamping;
      continue;
    }
    const double gain = summary.final_cost - value;
    summary.final_cost = value;
    if (current != Current::Gradient && gain <= kConverged * value) break;
    const bool keep_matrix = current != Current::Gradient && damping == kDamping && gain < kSmall * value;
    current = keep_matrix ? Current::Gradient : Current::Nothing;
    if (keep_matrix) around.update_gradient();
    damping = kDamping;
  }
  return summary;
}

}  // namespace edged
