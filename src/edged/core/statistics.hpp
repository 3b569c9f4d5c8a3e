// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Robust statistics of a few numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace edged {

inline double square(double x) { return x * x; }

/// Upper median; 0 for no values.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// 1.4826 times the median distance from `centre`: the standard deviation of normal values, outliers or not.
inline double robust_deviation(std::vector<double> values, double centre) {
  for (double& v : values) v = std::abs(v - centre);
  return 1.4826 * median(std::move(values));
}

}  // namespace edged
