// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cost of a window: its terms, as one list that is solved and marginalised alike.
#pragma once

#include <set>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

/// Which observations count. What stays of a landmark when its anchor leaves may only hang on states that will be
/// marginalised, not dropped.
enum class Observations { All, OfKeyframes };

/// An observation of a landmark and the one before it in the track of the same camera. The errors of two cameras are
/// independent: the first observation of another camera than the anchor's stands beside the anchor's.
struct TrackStep {
  ObservationKey before, seen;
  double correlation;  ///< of the errors of the two
  double sigma;        ///< of what the observation before does not tell, on the unit plane
};

/// The observations of a landmark one after the other: of the anchor's camera from the anchor on, then back in time
/// from there; then each other camera's in order.
std::vector<TrackStep> track_steps(const Window& window, const Feature& feature,
                                   Observations observations = Observations::All);

/// A residual (2) of a landmark: weight * (e - correlation * e of the residual before).
struct LandmarkResidual {
  ObservationKey seen;
  std::size_t place;      ///< of the state in the window, the oldest being 0
  Eigen::Vector2d point;  ///< on the unit plane
  double correlation;     ///< 0 where the one before is the anchor's, which is exact by the landmark's choice
  double weight;          ///< 1 / sigma
};

/// All that the views of a landmark say of it.
struct LandmarkTerm {
  FeatureId id = 0;
  ObservationKey anchor;
  std::size_t anchor_place = 0;
  Eigen::Vector2d point;                  ///< in the anchor view
  const double* inverse_depth = nullptr;  ///< in the window
  bool coupled = false;                   ///< its depth shares a factor with another's: not to be eliminated by itself
  std::vector<LandmarkResidual> residuals;
};

/// The terms of a window, each once. They borrow from it: use them before it changes in more than its blocks' values.
struct Cost {
  std::shared_ptr<const LinearPriorFactor> prior;  ///< what marginalisation has left; null without
  std::vector<std::shared_ptr<const Factor>> factors;
  std::vector<LandmarkTerm> landmarks;
};

Cost cost_of(const Window& window, Observations observations = Observations::All);

/// The blocks that its terms are of; not the inverse depths that can be eliminated one by one.
std::set<BlockKey> blocks_of(const Cost& cost);

/// Root mean square of what the IMU's factors are off by [sigma]. Small as long as nothing pulls against the IMU,
/// because it is the stiffest of all: to make up motion that it has not felt takes more than any right landmark asks
/// for.
double imu_strain(const Window& window);

}  // namespace edged
