// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// By how much a lamp that flickers shifts the instants of the images of a standard camera.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/frontend/tracker.hpp"

namespace edged {

/// An exposure counts the instants of bright light for more, so that an image shows the scene at another instant than
/// the middle of its exposure, up to a millisecond before or after. This shift is a sine of the phase of the lamp at
/// the stamp; its size depends on modulation and exposure, which are not known. Both coefficients are estimated from
/// the displacement of features against the predicted one: a feature that is ahead shows a later instant.
class ExposureShift {
 public:
  /// phase: of the lamp at the stamp of the image [rad]; since_last: from the image before; tracks: into this image;
  /// prediction: of them.
  void update(double phase, Duration since_last, const std::vector<Track>& tracks, const TrackPrediction& prediction);
  /// No lamp flickers.
  void reset() { *this = {}; }

  /// Shift of the newest image [s]: later, if positive.
  double seconds() const { return shift_s_; }
  /// Moves the observations of the newest image to its stamp. tracks: of the observations, in their order.
  void correct(CameraObservations& observations, const std::vector<Track>& tracks) const;

 private:
  bool any_ = false;
  Eigen::Vector2d wave_ = Eigen::Vector2d::Zero();  // cosine and sine of the phase at the newest image
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d weighted_ = Eigen::Vector2d::Zero();
  double shift_s_ = 0.0, since_last_s_ = 0.0;
  SE3 T_prev_cur_;  // of the camera, predicted
  double scene_depth_ = 1.0;
};

}  // namespace edged
