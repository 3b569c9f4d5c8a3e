// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Paper Eq. 4: a low-pass filter of valid depth measurements, whose estimate expires with age.
#pragma once

#include <optional>

#include "edged/depth/depth_prior.hpp"
#include "edged/options/depth.hpp"

namespace edged {

/// ln d_t = a ln d + (1 - a) ln d_(t-1), a = 1 - exp(-dt / time_constant): the paper's alpha, for any rate. The first
/// valid measurement, and the first after one has become too old, restarts the filter.
class DepthFilter {
 public:
  explicit DepthFilter(const DepthFilterConfig& config) : config_(config) {}

  /// True when the measurement was accepted.
  bool add(const DepthEstimate& measured);

  std::optional<DepthEstimate> at(Timestamp t) const;

 private:
  DepthFilterConfig config_;
  std::optional<DepthEstimate> estimate_;
};

}  // namespace edged
