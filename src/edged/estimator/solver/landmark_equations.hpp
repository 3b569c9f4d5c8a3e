// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The part of landmarks in the normal equations and in the cost.
#pragma once

#include "edged/estimator/solver/linear_system.hpp"
#include "edged/estimator/window/camera_poses.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {

/// What equations are for: a step to the minimum, or what is known of the states. A depth that is hardly known is
/// overestimated where only large parallax makes a landmark, and with it what the landmark tells of a translation: that
/// counts as at the depth that is certain (decision 016).
enum class Purpose { Solution, Information };

/// Adds landmarks one by one.
class LandmarkEquations {
 public:
  /// Layout and equations must outlive this.
  LandmarkEquations(const Window& window, const Layout& layout, NormalEquations& equations,
                    Purpose purpose = Purpose::Solution);
  /// An inverse depth without a place in the layout is eliminated, and added to `eliminated` if there is one.
  void add(const LandmarkTerm& term, std::vector<DepthEquation>* eliminated);
  /// Adds to the gradient alone. An inverse depth is eliminated by its equation of an earlier linearization, if it has
  /// one, which takes the new gradient.
  void add_gradient(const LandmarkTerm& term, DepthEquation* earlier);

 private:
  void place(const LandmarkTerm& term);
  template <typename Use>
  void linearise(const LandmarkTerm& term, double rho, const Use& use) const;
  double certain_inverse_depth(const LandmarkTerm& term) const;
  void accumulate(std::size_t residual, const ObservationError& error, const ObservationError& before,
                  const LandmarkTerm& term);
  void add_own();
  void add_depth(Eigen::Index place);
  void eliminate_depth();

  const Layout& layout_;
  NormalEquations& equations_;
  Purpose purpose_;
  CameraPoses views_;
  const ceres::LossFunction& loss_;
  std::vector<Eigen::Index> poses_, calibrations_;  ///< global columns, by the index of a state and of a camera

  // Of the present landmark. Columns: the anchor's pose, the calibration of its camera.
  static constexpr int kOwn = 6 + kCalibrationSize;
  Eigen::Matrix<double, kOwn, kOwn, Eigen::RowMajor> H_;
  Eigen::Matrix<double, kOwn, 1> g_, coupling_;
  DepthEquation depth_;
  std::vector<std::size_t> pose_of_, calibration_of_;  ///< by residual: its index in depth_
};

/// Half the sum of the landmark's squared residuals, with the loss; infinite if it is behind a camera.
double value_of(const LandmarkTerm& term, const CameraPoses& views, const ceres::LossFunction& loss);

}  // namespace edged
