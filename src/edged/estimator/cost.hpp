// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cost of a window: its factors, as one list that is solved and marginalised alike.
#pragma once

#include <set>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

/// Which observations count. What stays of a landmark when its anchor leaves may only hang on states that will be
/// marginalised, not dropped.
enum class Observations { All, OfKeyframes };

/// The terms of the present window, each once. They borrow from the window: use them before it
/// changes.
std::vector<Factor> factors_of(Window& window, Observations observations = Observations::All);

/// An observation of a landmark and its neighbour towards the anchor.
struct TrackStep {
  StateId before, seen;
  double correlation;  ///< of the errors of the two
  double sigma;        ///< of what the observation before does not tell, on the unit plane
};

/// The observations of a landmark one after the other, from its anchor's on, then those before the anchor's, back in
/// time.
std::vector<TrackStep> track_steps(const Window& window, const Feature& feature,
                                   Observations observations = Observations::All);

/// The inverse depths that share a factor with another: they cannot be eliminated one by one.
std::set<BlockKey> coupled_depths(const std::vector<Factor>& factors);

/// Root mean square of what the IMU's factors are off by [sigma]. Small as long as nothing pulls against the IMU,
/// because it is the stiffest of all: to make up motion that it has not felt takes more than any right landmark asks
/// for.
double imu_strain(const Window& window);

}  // namespace edged
