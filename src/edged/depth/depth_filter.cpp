// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/depth_filter.hpp"

#include <algorithm>
#include <cmath>

namespace edged {

void DepthFilterConfig::visit(ConfigFields& fields) {
  fields.add("min_m", min_m, {"m", 0.001, 100, "A smaller depth measurement is rejected."});
  fields.add("max_m", max_m, {"m", 0.1, 10000, "A larger depth measurement is rejected."});
  fields.add(
      "time_constant_s", time_constant_s,
      {"s", 0, 60, "Time constant of the low-pass filter of ln depth (paper Eq. 4). The gain is 1 - exp(-dt / this)."});
}

bool DepthFilter::add(const DepthEstimate& measured) {
  if (!(measured.depth_m > config_.min_m && measured.depth_m < config_.max_m)) return false;
  if (estimate_ && measured.t < estimate_->t) return false;
  const double dt = estimate_ ? to_seconds(measured.t - estimate_->t) : config_.max_age_s + 1.0;
  const bool afresh = dt > config_.max_age_s || config_.time_constant_s <= 0.0;
  if (!estimate_ || afresh) {
    estimate_ = measured;
    return true;
  }
  const double a = 1.0 - std::exp(-dt / config_.time_constant_s);
  const auto blend = [a](double now, double before) { return a * now + (1.0 - a) * before; };
  estimate_->t = measured.t;
  estimate_->depth_m = std::exp(blend(std::log(measured.depth_m), std::log(estimate_->depth_m)));
  // Errors of one source are correlated in time, so smoothing does not reduce them.
  estimate_->sigma_ln = blend(measured.sigma_ln, estimate_->sigma_ln);
  estimate_->spread_ln = blend(measured.spread_ln, estimate_->spread_ln);
  return true;
}

std::optional<DepthEstimate> DepthFilter::at(Timestamp t) const {
  if (!estimate_) return std::nullopt;
  const double age_s = std::max(0.0, to_seconds(t - estimate_->t));
  if (age_s > config_.max_age_s) return std::nullopt;
  DepthEstimate held = *estimate_;
  held.sigma_ln = std::hypot(held.sigma_ln, config_.drift * std::sqrt(age_s));
  return held;
}

}  // namespace edged
