// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options/depth.hpp"

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

}  // namespace edged
