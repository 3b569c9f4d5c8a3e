// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compares the images of frame cameras that see the same: whether each is the camera that the calibration says.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Matches corners of the first camera with those of each other one, by the calibration and by that with both
/// exchanged.
class StereoAgreement {
 public:
  /// Other than frame cameras are ignored.
  explicit StereoAgreement(std::span<const RigCamera> cameras);

  /// Uses a few images of one instant, of which that of the first camera comes first.
  void add(const Measurement& measurement);

  /// The pairs that match only if exchanged, each "NAME and NAME".
  std::vector<std::string> exchanged() const;

 private:
  struct Other {
    RigCamera camera;
    Timestamp due = Timestamp::min();  ///< of the next comparison
    int compared = 0;
    int as_given = 0, exchanged = 0;  ///< corners that match
  };

  void compare(const Frame& frame, Other& other) const;

  std::optional<RigCamera> first_;
  Frame image_;  ///< the newest one of it
  std::vector<Other> others_;
};

}  // namespace edged
