// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Paper Eq. 4: what is valid of a sequence of depth measurements, smoothed, held and given up with age.
#pragma once

#include <optional>

#include "edged/core/config.hpp"
#include "edged/depth/depth_prior.hpp"

namespace edged {

struct DepthFilterConfig {
  double min_m = 0.15;  ///< measurements outside (min, max) are rejected, the estimate before is held
  double max_m = 30.0;
  double time_constant_s = 0.25;  ///< of the smoothing; 0: none
  double max_age_s = 1.0;         ///< an estimate is held that long
  double drift = 0.3;             ///< growth of sigma_ln [1/sqrt(s)]

  void visit(ConfigFields& fields);
};

/// ln d_t = a ln d + (1 - a) ln d_(t-1), a = 1 - exp(-dt / time_constant): the paper's alpha, for any rate. The first
/// valid measurement, and the first after one has become too old, starts afresh.
class DepthFilter {
 public:
  explicit DepthFilter(const DepthFilterConfig& config) : config_(config) {}

  /// True when the measurement was taken.
  bool add(const DepthEstimate& measured);

  std::optional<DepthEstimate> at(Timestamp t) const;

 private:
  DepthFilterConfig config_;
  std::optional<DepthEstimate> estimate_;
};

}  // namespace edged
