// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/frozen_readings.hpp"

#include <algorithm>

namespace edged {

void FrozenDetector::add(Timestamp t, const Eigen::Vector3d& value) {
  if (!begun_) {
    begun_ = true;
    first_ = all_since_ = t;
    axis_since_.fill(t);
    result_.value = value;
    result_.since = t;
  } else {
    for (std::size_t axis = 0; axis < axis_since_.size(); ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      if (value[i] != last_[i]) axis_since_[axis] = t;
      result_.axes[axis] = std::max(result_.axes[axis], t - axis_since_[axis]);
    }
    if (value != last_) all_since_ = t;
    if (t - all_since_ > result_.longest) {
      result_.longest = t - all_since_;
      result_.since = all_since_;
      result_.value = value;
    }
  }
  last_ = value;
  result_.covered = t - first_;
}

}  // namespace edged
