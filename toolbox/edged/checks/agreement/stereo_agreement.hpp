// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compares the images of cameras of one kind that see the same: whether each is the camera that the calibration says.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Matches corners of the first camera of its kind with those of each other one, by the calibration and by that with
/// both exchanged. The image of an event camera holds the events of a short time.
class StereoAgreement {
 public:
  explicit StereoAgreement(std::span<const RigCamera> cameras);

  /// Uses a few images of one instant.
  void add(const Measurement& measurement);

  /// The pairs that match only if exchanged, each "NAME and NAME".
  std::vector<std::string> exchanged() const;

 private:
  struct Camera {
    RigCamera given;
    std::size_t first = 0;             ///< of its kind, an index of cameras_
    Frame image = {};                  ///< the newest one
    cv::Mat counts = {};               ///< of events, for the next one
    Timestamp due = Timestamp::min();  ///< of the next comparison with the first
    int compared = 0;
    int as_given = 0, exchanged = 0;  ///< corners that match
  };

  void count(Camera& camera, const EventBatch& batch);
  void show(Camera& camera, Frame image);
  static void compare(const Camera& one, Camera& other);

  std::vector<Camera> cameras_;
};

}  // namespace edged
