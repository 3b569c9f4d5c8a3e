// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What landmarks add to the normal equations and to the cost.
#pragma once

#include "edged/estimator/camera_views.hpp"
#include "edged/estimator/cost.hpp"
#include "edged/estimator/linear_system.hpp"

namespace edged {

/// Adds one landmark after the other; keeps its memory in between.
class LandmarkEquations {
 public:
  LandmarkEquations(Window& window, const Layout& layout, Linearisation at);
  void add(const LandmarkTerm& term, NormalEquations& equations, std::vector<EliminatedDepth>* eliminated);

 private:
  void linearise(const LandmarkTerm& term);
  void accumulate(std::size_t residual, const ObservationError& error, const ObservationError& before,
                  const LandmarkTerm& term);
  void place(const LandmarkTerm& term);
  void eliminate_depth(const LandmarkTerm& term, std::vector<EliminatedDepth>* eliminated);

  const Layout& layout_;
  CameraViews present_, taken_;
  bool at_present_;  ///< the two are the same
  ceres::LossFunction* loss_;
  // Columns: the anchor's pose, the camera's calibration, the inverse depth, the pose of every residual's state.
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_, coupling_;
  std::vector<Placed> blocks_;
};

/// Half the sum of its squares, the loss applied; infinite where it is behind a camera.
double value_of(const LandmarkTerm& term, const CameraViews& views, const ceres::LossFunction& loss);

}  // namespace edged
