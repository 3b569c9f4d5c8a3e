// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tracks of the points of a test world that end where a point leaves the view.
#pragma once

#include <map>

#include "edged/estimator/window/estimator_input.hpp"

namespace edged {

/// Gives a point that comes into view again a new id, as a tracker does.
class TracksOnce {
 public:
  void rename(EstimatorInput& input) {
    ++packet_;
    for (CameraObservations& view : input.observations) {
      for (FeatureObservation& seen : view.features) {
        Track& track = tracks_[seen.id];
        if (track.packet + 1 < packet_) track.id = next_++;
        track.packet = packet_;
        seen.id = track.id;
      }
    }
  }

 private:
  struct Track {
    FeatureId id = 0;
    std::size_t packet = 0;
  };
  std::map<FeatureId, Track> tracks_;
  std::size_t packet_ = 1;
  FeatureId next_ = 1;
};

}  // namespace edged
