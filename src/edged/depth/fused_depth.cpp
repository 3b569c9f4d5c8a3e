// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/fused_depth.hpp"

#include <algorithm>
#include <cmath>

namespace edged {

void ScaleEstimate::update(Timestamp t, double ln_ratio) {
  const double dt = t_ ? std::max(0.0, to_seconds(t - *t_)) : 0.0;
  t_ = t;
  const double variance = sigma_ * sigma_ + kSceneDepthTuning.scale_walk * kSceneDepthTuning.scale_walk * dt;
  const double innovation = ln_ratio - ln_scale_;
  double noise = kSceneDepthTuning.scale_measurement_sigma * kSceneDepthTuning.scale_measurement_sigma;
  const double sigmas = std::abs(innovation) / std::sqrt(variance + noise);
  if (sigmas > 2.0) noise *= sigmas / 2.0 * (sigmas / 2.0);
  const double gain = variance / (variance + noise);
  ln_scale_ += gain * innovation;
  sigma_ = std::sqrt((1.0 - gain) * variance);
}

FusedDepth::FusedDepth(ConstantDepth constant, LandmarkDepth landmarks, std::unique_ptr<NetworkDepth> network)
    : constant_(constant), landmarks_(std::move(landmarks)), network_(std::move(network)) {}

void FusedDepth::add_events(std::span<const Event> events) {
  const int before = network_->inferences();
  network_->add_events(events);
  if (network_->inferences() == before) return;
  const DepthEstimate& window = *network_->measured();
  if (const auto truth = landmarks_.at(window.t))
    scale_.update(window.t, std::log(truth->depth_m) - std::log(window.depth_m));
}

std::optional<DepthEstimate> FusedDepth::at(Timestamp t) const {
  const std::optional<DepthEstimate> near = landmarks_.at(t);
  std::optional<DepthEstimate> net = network_->at(t);
  if (net) net->depth_m *= std::exp(scale_.ln_scale());
  // The error of the network is mostly its scale: the uncertainty of s replaces it, plus the noise from window to
  // window.
  if (net) net->sigma_ln = std::min(net->sigma_ln, std::hypot(net->sigma_ln * 0.5, scale_.sigma()));
  if (!near && !net) return constant_.at(t);
  if (!near || !net) return near ? near : net;
  const double w_near = 1.0 / (near->sigma_ln * near->sigma_ln), w_net = 1.0 / (net->sigma_ln * net->sigma_ln);
  const double ln_depth = (w_near * std::log(near->depth_m) + w_net * std::log(net->depth_m)) / (w_near + w_net);
  return DepthEstimate{std::max(near->t, net->t), std::exp(ln_depth), 1.0 / std::sqrt(w_near + w_net), near->spread_ln};
}

}  // namespace edged
