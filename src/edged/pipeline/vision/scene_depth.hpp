// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The scene depth of a run: for the warp and the prediction of tracks (paper Eq. 2, 4), and for the estimator's depth
// factor (Eq. 5), whose source must not use the landmarks.
#pragma once

#include <memory>
#include <span>

#include "edged/core/observation.hpp"
#include "edged/depth/depth_prior.hpp"
#include "edged/depth/landmark_depth.hpp"
#include "edged/options/depth.hpp"
#include "edged/rig.hpp"

namespace edged {

class SceneDepth {
 public:
  /// camera: the event camera, or the frame camera if there is none: then a network has no input. for_factor: run the
  /// network for the depth factor, independent of the depth source of the warp.
  SceneDepth(const DepthConfig& config, const RigCamera& camera, bool for_factor,
             Inference inference = Inference::Synchronous);

  /// New events, raw pixels, in time order.
  void add_events(std::span<const Event> events);
  /// All landmarks in view at t, in the camera.
  void add_landmarks(Timestamp t, std::span<const SeenDepth> landmarks) { prior_->add_landmarks(t, landmarks); }

  /// z-depth [m]; the constant if no source has one.
  double at(Timestamp t) const;
  /// The depth that Eq. 5 compares with the landmarks.
  std::optional<RegionDepth> for_factor(Timestamp t) const;

 private:
  double constant_m_;
  std::string camera_;
  CentralRegion region_;
  std::unique_ptr<DepthPrior> prior_;
  std::unique_ptr<DepthPrior> own_network_;  // of the factor, unless the prior is a network already
  const DepthPrior* factor_source_ = nullptr;
};

}  // namespace edged
