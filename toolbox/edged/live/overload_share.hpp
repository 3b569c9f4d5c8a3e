// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The share of new events that stays where there are more than can be processed, by the delay.
#pragma once

#include <algorithm>
#include <cmath>

namespace edged {

/// It follows the delay at once; were that all, the delay would stay as long as the overload does. So a delay that
/// lasts changes a lasting share, too, until the delay is free again.
class OverloadShare {
 public:
  static constexpr double kLeast = 0.08;

  /// delay: 1 is the longest that is free. passed_s: since the last call. From kLeast to 1.
  double next(double delay, double passed_s) {
    constexpr double kRemembered_s = 0.1;  // in which a delay of 2 lowers the lasting share by its e-fold
    constexpr double kWorst = 3.0;         // a longer delay does not change it faster
    lasting_ *= std::exp(passed_s / kRemembered_s * (1.0 - std::min(delay, kWorst)));
    lasting_ = std::clamp(lasting_, kLeast, 1.0);
    return std::max(kLeast, lasting_ / std::max(delay, 1.0));
  }

 private:
  double lasting_ = 1.0;
};

}  // namespace edged
