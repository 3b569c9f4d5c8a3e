// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Robust statistics of a few numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace edged {

/// Upper median; values must not be empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// 1.4826 times the median distance from `centre`: the standard deviation of normal values without outliers.
inline double robust_deviation(std::vector<double> values, double centre) {
  for (double& v : values) v = std::abs(v - centre);
  return 1.4826 * upper_median(std::move(values));
}

}  // namespace edged
