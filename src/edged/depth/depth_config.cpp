// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options/depth.hpp"

namespace edged {

void DepthConfig::visit(ConfigFields& fields) {
  fields.choice(
      "source", source,
      {{"constant", DepthSource::Constant},
       {"landmarks", DepthSource::Landmarks},
       {"network", DepthSource::Network},
       {"fused", DepthSource::Fused}},
      {.effect = "where the depth of the scene comes from; fused: landmarks, the network with a scale learned "
                 "from them, and the constant where both are missing"});
  fields.add("constant_m", constant_m, {"m", 0.05, 1000, "scene depth where nothing is known"});
  fields.add("constant_sigma_ln", constant_sigma_ln, {"", 0.01, 10, "uncertainty of its logarithm"});
  fields.add("region_share", region_share, {"", 0.05, 1, "the central region's share of each side of the image"});
  fields.group("filter", filter);
  fields.group("landmarks", landmarks);
  fields.group("network", network);
  fields.group("scale", scale);
}

}  // namespace edged
