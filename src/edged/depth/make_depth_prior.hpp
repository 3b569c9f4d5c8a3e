// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Makes the scene depth source that the options select.
#pragma once

#include <memory>

#include "edged/depth/depth_prior.hpp"
#include "edged/options/depth.hpp"
#include "edged/rig.hpp"

namespace edged {

/// camera: the event camera, raw (distorted). Throws InputError when the network's model cannot be used.
std::unique_ptr<DepthPrior> make_depth_prior(const DepthConfig& config, const CameraModel& camera,
                                             Inference inference = Inference::Synchronous);

}  // namespace edged
