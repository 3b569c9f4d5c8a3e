// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Fusion of landmarks and network: the landmarks give the scale, the network serves where they are missing.
#pragma once

#include <memory>

#include "edged/depth/landmark_depth.hpp"
#include "edged/depth/network_depth.hpp"
#include "edged/depth/tuning.hpp"

namespace edged {

class ScaleEstimate {
 public:
  /// ln of the true depth over the source's; beyond two sigma it weighs less, so that an outlier moves ln s little.
  void update(Timestamp t, double ln_ratio);

  double ln_scale() const { return ln_scale_; }
  double sigma() const { return sigma_; }

 private:
  double ln_scale_ = 0.0, sigma_ = kSceneDepthTuning.scale_sigma;
  std::optional<Timestamp> t_;
};

/// The mean of ln depth, weighted by inverse variance, of the landmarks and of s times the network; without either, the
/// constant. s is estimated while both are available.
class FusedDepth : public DepthPrior {
 public:
  FusedDepth(ConstantDepth constant, LandmarkDepth landmarks, std::unique_ptr<NetworkDepth> network);

  void add_events(std::span<const Event> events) override;
  void add_landmarks(Timestamp t, std::span<const SeenDepth> landmarks) override {
    landmarks_.add_landmarks(t, landmarks);
  }
  std::optional<DepthEstimate> at(Timestamp t) const override;

  const ScaleEstimate& scale() const { return scale_; }
  const NetworkDepth& network() const { return *network_; }

 private:
  ConstantDepth constant_;
  LandmarkDepth landmarks_;
  std::unique_ptr<NetworkDepth> network_;
  ScaleEstimate scale_;
};

}  // namespace edged
