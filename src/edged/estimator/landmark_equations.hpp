// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What landmarks add to the normal equations and to the cost.
#pragma once

#include "edged/estimator/normal_equations.hpp"

namespace edged {

/// Every camera at every state of a window. Borrows from the window.
class CameraViews {
 public:
  CameraViews(Window& window, Linearisation at);
  const CameraOnBody& camera(std::size_t camera) const { return cameras_[camera]; }
  /// place: of the state in the window, the oldest being 0.
  const CameraAt& at(std::size_t camera, std::size_t place) const { return views_[camera * states_ + place]; }
  /// From the pose that was taken to the present one.
  const Vector6d& moved(std::size_t place) const { return moved_[place]; }

 private:
  std::size_t states_;
  std::vector<CameraOnBody> cameras_;
  std::vector<CameraAt> views_;
  std::vector<Vector6d> moved_;
};

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
  ceres::LossFunction* loss_;
  // Columns: the anchor's pose, the camera's calibration, the inverse depth, the pose of every residual's state.
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_, coupling_;
  std::vector<Placed> blocks_;
};

/// Its share of value_of().
double value_of(const LandmarkTerm& term, const CameraViews& views, const ceres::LossFunction& loss);

}  // namespace edged
