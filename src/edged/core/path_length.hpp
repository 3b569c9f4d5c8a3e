// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How long a path is.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace edged {

/// Sum of the steps from each pose to the next [m]. pose: the member of an element that it is.
template <typename Element, typename Pose>
double path_length(const std::vector<Element>& path, Pose pose) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += (std::invoke(pose, path[i]).translation() - std::invoke(pose, path[i - 1]).translation()).norm();
  }
  return length;
}

}  // namespace edged
