// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cost of a window: one list of terms, for solving and for marginalization.
#pragma once

#include <ceres/loss_function.h>

#include <functional>
#include <set>
#include <span>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {

/// Which observations are in the cost. When the anchor of a landmark is marginalized, the prior may only depend on
/// states that will be marginalized, not dropped.
enum class Observations { All, OfKeyframes };

/// An observation of a landmark and the one before it in the track of the same camera. The errors of two cameras are
/// independent: the first observation of another camera follows the anchor's.
struct TrackStep {
  ObservationKey before, seen;
  double correlation;  ///< correlation of the errors of the two
  double sigma;        ///< sigma of the part that is independent of the observation before, on the unit plane
};

/// The observations of a landmark one after the other: of the anchor's camera from the anchor on, then back in time
/// from there; then each other camera's in order.
std::vector<TrackStep> track_steps(const Window& window, const Feature& feature,
                                   Observations observations = Observations::All);

/// A residual (2) of a landmark: weight * (e - correlation * e of the residual before).
struct LandmarkResidual {
  ObservationKey seen;
  std::size_t place;  ///< place of the state in the window, the oldest being 0
  ImagePoint point;
  double correlation;  ///< 0 if the one before is the anchor's, which is exact by definition of the landmark
  double weight;       ///< 1 / sigma
};

/// All residuals of a landmark.
struct LandmarkTerm {
  FeatureId id = 0;
  ObservationKey anchor;
  std::size_t anchor_place = 0;
  ImagePoint point;                       ///< in the anchor view
  const double* inverse_depth = nullptr;  ///< in the window
  bool coupled = false;                   ///< its depth shares a factor with others: not eliminated by itself
  std::vector<LandmarkResidual> residuals;
};

/// The terms of a window, each once. They refer to the window: do not use them after it changes in more than the values
/// of its blocks.
struct Cost {
  std::shared_ptr<const LinearPriorFactor> prior;  ///< the prior of marginalization; null without one
  std::vector<std::shared_ptr<const Factor>> factors;
  std::vector<LandmarkTerm> landmarks;
};

Cost cost_of(const Window& window, Observations observations = Observations::All);

/// The robust loss of all observations.
const ceres::LossFunction& visual_loss();

/// Visits the blocks that each term couples, without the inverse depths that can be eliminated one by one.
void for_each_term(const Cost& cost, const std::function<void(std::span<const BlockKey>)>& visit);

/// All of them.
std::set<BlockKey> blocks_of(const Cost& cost);

/// Root mean square of the residuals of the IMU factors [sigma]. Small as long as cameras and IMU agree: IMU factors
/// are the stiffest terms, so correct landmarks cannot force a motion that the IMU has not measured.
double imu_strain(const Window& window);

}  // namespace edged
