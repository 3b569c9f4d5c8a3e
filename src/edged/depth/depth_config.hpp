// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which depth prior a run uses, with all its options, and the one function that makes it.
#pragma once

#include <memory>

#include "edged/depth/fused_depth.hpp"

namespace edged {

enum class DepthSource { Constant, Landmarks, Network, Fused };

struct DepthConfig {
  DepthSource source = DepthSource::Landmarks;
  double constant_m = 2.0;
  double constant_sigma_ln = 0.7;
  double region_share = 0.5;  ///< of each side of the image, around its middle
  DepthFilterConfig filter;
  LandmarkDepthConfig landmarks;
  NetworkDepthConfig network;
  ScaleConfig scale;

  void visit(ConfigFields& fields);
};

/// camera: the event camera, raw (distorted). Throws InputError when the network's model cannot be used.
std::unique_ptr<DepthPrior> make_depth_prior(const DepthConfig& config, const CameraModel& camera,
                                             Inference inference = Inference::Synchronous);

}  // namespace edged
