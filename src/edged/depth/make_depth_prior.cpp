// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/make_depth_prior.hpp"

#include "edged/core/check.hpp"
#include "edged/depth/fused_depth.hpp"
#include "edged/depth/tuning.hpp"

namespace edged {

void DepthConfig::visit(ConfigFields& fields) {
  fields.choice("source", source,
                {{"constant", DepthSource::Constant},
                 {"landmarks", DepthSource::Landmarks},
                 {"network", DepthSource::Network},
                 {"fused", DepthSource::Fused}},
                {.effect = "Source of the scene depth. fused: landmarks, a network scaled to them, and the constant if "
                           "both are missing."});
  fields.add("constant_m", constant_m, {"m", 0.05, 1000, "Scene depth when no source has a measurement."});
  fields.add("region_share", region_share,
             {"", 0.05, 1, "Size of the central region, as a share of each side of the image."});
  fields.group("filter", filter);
  fields.group("network", network);
}

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
