// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The landmarks of a whole run as points to show: a bounded number, spread evenly.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>

#include "edged/state.hpp"

namespace edged {

class SeenPoints {
 public:
  explicit SeenPoints(std::size_t most) : most_(most) {}

  /// Adds the landmarks of a keyframe. A landmark has the place of its last keyframe.
  void add(std::span<const Landmark> landmarks) {
    for (const Landmark& landmark : landmarks) {
      if (landmark.id % every_ != 0 || !landmark.p_W.allFinite()) continue;
      const Eigen::Vector3f p = landmark.p_W.cast<float>();
      points_[landmark.id] = {p.x(), p.y(), p.z()};
    }
    while (points_.size() > most_) {
      every_ *= 2;
      std::erase_if(points_, [this](const auto& point) { return point.first % every_ != 0; });
    }
  }

  /// x, y, z [m] in the world of the estimate, by landmark.
  const std::map<FeatureId, std::array<float, 3>>& all() const { return points_; }

 private:
  std::size_t most_;
  FeatureId every_ = 1;  ///< only multiples of it are kept
  std::map<FeatureId, std::array<float, 3>> points_;
};

}  // namespace edged
