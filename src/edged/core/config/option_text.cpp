// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/config/option_text.hpp"

#include <algorithm>
#include <sstream>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/se3.hpp"

namespace edged {

Eigen::Vector3d three_numbers(const std::string& text, std::string_view key) {
  std::string spaced = text;
  std::ranges::replace(spaced, ',', ' ');
  std::istringstream in(spaced);
  Eigen::Vector3d numbers;
  std::string rest;
  if (!(in >> numbers.x() >> numbers.y() >> numbers.z()) || in >> rest || !numbers.allFinite())
    throw InputError::format("{}: '{}' is not three numbers such as \"0.1 0 -0.05\"", key, text);
  return numbers;
}

Eigen::Quaterniond rotation_of(const Eigen::Vector3d& angles) {
  return so3::exp(Eigen::Vector3d(0.0, 0.0, angles.z())) * so3::exp(Eigen::Vector3d(0.0, angles.y(), 0.0)) *
         so3::exp(Eigen::Vector3d(angles.x(), 0.0, 0.0));
}

Eigen::Quaterniond rotation_of_degrees(const std::string& text, std::string_view key) {
  return rotation_of(kDegree * three_numbers(text, key));
}

}  // namespace edged
