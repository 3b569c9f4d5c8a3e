// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The ground truth of a recording, and where it contradicts itself.
#pragma once

#include <cstddef>
#include <string>

#include "edged/checks/statistics/stream_statistics.hpp"
#include "edged/dataset.hpp"

namespace edged {

/// A step between two poses that no body makes.
struct TruthJump {
  Timestamp t;  ///< of the pose after it
  double length_m = 0.0, angle_rad = 0.0;
};

struct TruthStatistics {
  StreamStatistics stream;
  std::string frame = {};  ///< whose pose it is
  double path_m = 0.0;     ///< length of the path
  std::size_t jumps = 0;
  TruthJump first_jump = {};
  Duration frozen{0};  ///< the longest time of one pose, to the last bit, that begins or ends in motion
  Timestamp frozen_since = {};
};

TruthStatistics truth_statistics(const GroundTruth& truth);

}  // namespace edged
