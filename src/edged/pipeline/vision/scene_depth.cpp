// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/scene_depth.hpp"

#include "edged/depth/make_depth_prior.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
SceneDepth::SceneDepth(const DepthConfig& config, const RigCamera& camera, bool for_factor, Inference inference)
    : constant_m_(config.constant_m),
      camera_(camera.name),
      region_(camera.model, config.region_share),
      prior_(make_depth_prior(config, camera.model, inference)) {
  if (!for_factor || camera.modality != Modality::Events) return;
  if (config.source != DepthSource::Network) {
    DepthConfig network = config;
    network.source = DepthSource::Network;
    own_network_ = make_depth_prior(network, camera.model, inference);
  }
  factor_source_ = own_network_ ? own_network_.get() : prior_.get();
}

void SceneDepth::add_events(std::span<const Event> events) {
  prior_->add_events(events);
  if (own_network_) own_network_->add_events(events);
}

double SceneDepth::at(Timestamp t) const {
  const std::optional<DepthEstimate> estimate = prior_->at(t);
  return estimate ? estimate->depth_m : constant_m_;
}

std::optional<RegionDepth> SceneDepth::for_factor(Timestamp t) const {
  const std::optional<DepthEstimate> d = factor_source_ ? factor_source_->at(t) : std::nullopt;
  if (!d || t - d->t > kPipelineTuning.max_depth_age) return std::nullopt;
  return RegionDepth{camera_, region_.low, region_.high, d->depth_m, d->sigma_ln, d->spread_ln};
}

}  // namespace edged
