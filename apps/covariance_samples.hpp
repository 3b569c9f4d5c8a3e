// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// From the steps of a run to what the evaluation of consistency wants.
#pragma once

#include <vector>

#include "edged/eval/consistency.hpp"
#include "edged/odometry.hpp"

namespace edged {

/// Gathers the poses whose covariance was worked out anew, and all Degraded ones that have one; a loss ends a start,
/// and so does being found again.
class CovarianceSamples {
 public:
  /// Every step, in time order.
  void add(const Step& step);
  const std::vector<PoseCovarianceSample>& all() const { return samples_; }

 private:
  std::vector<PoseCovarianceSample> samples_;
  int start_ = 0;
};

}  // namespace edged
