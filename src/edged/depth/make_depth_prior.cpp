// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/make_depth_prior.hpp"

#include "edged/core/check.hpp"
#include "edged/depth/fused_depth.hpp"
#include "edged/depth/tuning.hpp"

namespace edged {

std::unique_ptr<DepthPrior> make_depth_prior(const DepthConfig& config, const CameraModel& camera,
                                             Inference inference) {
  const ConstantDepth constant(config.constant_m, kSceneDepthTuning.constant_sigma_ln);
  const LandmarkDepth landmarks(camera, config.region_share, config.filter);
  const auto network = [&] {
    return std::make_unique<NetworkDepth>(camera, config.region_share, config.network, config.filter, inference);
  };
  switch (config.source) {
    case DepthSource::Constant:
      return std::make_unique<ConstantDepth>(constant);
    case DepthSource::Landmarks:
      return std::make_unique<LandmarkDepth>(landmarks);
    case DepthSource::Network:
      return network();
    case DepthSource::Fused:
      return std::make_unique<FusedDepth>(constant, landmarks, network());
  }
  EDGED_CHECK(false, "depth source {}", static_cast<int>(config.source));
}

}  // namespace edged
