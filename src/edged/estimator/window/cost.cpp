// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/cost.hpp"

#include <cmath>
#include <iterator>

#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/depth_terms.hpp"

namespace edged {
namespace {

/// The inverse depths in factors: each factor couples several.
std::set<FeatureId> coupled_depths(const std::vector<std::shared_ptr<const Factor>>& factors) {
  std::set<FeatureId> coupled;
  for (const auto& factor : factors) {
    for (const BlockKey& key : factor->blocks()) {
      if (key.kind == BlockKind::InverseDepth) coupled.insert(key.id);
    }
  }
  return coupled;
}

std::vector<LandmarkTerm> landmark_terms(const Window& window, Observations observations,
                                         const std::set<FeatureId>& coupled) {
  std::map<StateId, std::size_t> place;
  for (const auto& [id, state] : window.states()) place.emplace(id, place.size());
  std::vector<LandmarkTerm> terms;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    const ObservationKey anchor = *feature.anchor;
    const ImagePoint point = feature.observations.at(anchor).image;
    LandmarkTerm term{id, anchor, place.at(anchor.state), point, &feature.inverse_depth, coupled.contains(id), {}};
    for (const TrackStep& step : track_steps(window, feature, observations)) {
      const double correlation = step.before == anchor ? 0.0 : step.correlation;
      term.residuals.push_back({step.seen, place.at(step.seen.state), feature.observations.at(step.seen).image,
                                correlation, 1.0 / step.sigma});
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

}  // namespace

Cost cost_of(const Window& window, Observations observations) {
  Cost cost;
  if (!window.prior()->blocks().empty()) cost.prior = window.prior();
  cost.factors.assign(window.soft_priors().begin(), window.soft_priors().end());
  cost.factors.insert(cost.factors.end(), window.factors().begin(), window.factors().end());
  add_depth_factors(window, cost.factors);
  cost.landmarks = landmark_terms(window, observations, coupled_depths(cost.factors));
  return cost;
}

const ceres::LossFunction& visual_loss() {
  static const ceres::CauchyLoss loss(kFactorTuning.cauchy_scale);
  return loss;
}

void for_each_term(const Cost& cost, const std::function<void(std::span<const BlockKey>)>& visit) {
  if (cost.prior) visit(cost.prior->blocks());
  for (const auto& factor : cost.factors) visit(factor->blocks());
  std::vector<BlockKey> blocks;
  for (const LandmarkTerm& term : cost.landmarks) {
    blocks.clear();
    if (term.coupled) blocks.push_back({BlockKind::InverseDepth, term.id});
    if (!term.residuals.empty()) {
      blocks.push_back({BlockKind::Pose, term.anchor.state});
      blocks.push_back({BlockKind::Calibration, term.anchor.camera});
    }
    for (const LandmarkResidual& residual : term.residuals) {
      blocks.push_back({BlockKind::Pose, residual.seen.state});
      blocks.push_back({BlockKind::Calibration, residual.seen.camera});
    }
    visit(blocks);
  }
}

std::set<BlockKey> blocks_of(const Cost& cost) {
  std::set<BlockKey> all;
  for_each_term(cost, [&](std::span<const BlockKey> blocks) { all.insert(blocks.begin(), blocks.end()); });
  return all;
}

std::vector<TrackStep> track_steps(const Window& window, const Feature& feature, Observations observations) {
  std::vector<TrackStep> steps;
  const auto anchor = feature.observations.find(*feature.anchor);
  const auto follow = [&](std::size_t camera, auto first, auto last) {
    const double at_once = window.track_noise().of(window.cameras()[camera].given.modality);
    ObservationKey before = anchor->first;
    for (auto observation = first; observation != last; ++observation) {
      const ObservationKey& seen = observation->first;
      if (seen.camera != camera) continue;
      const WindowState& state = window.states().at(seen.state);
      if (observations == Observations::OfKeyframes && !state.keyframe) continue;
      const double dt = std::abs(to_seconds(state.t - window.states().at(before.state).t));
      const double correlation =
          before.camera == camera ? at_once * std::exp(-dt / kLandmarkTuning.track_correlation_time_s) : 0.0;
      const double own = std::sqrt(1.0 - correlation * correlation);
      steps.push_back({before, seen, correlation, observation->second.sigma * own});
      before = seen;
    }
  };
  follow(anchor->first.camera, std::next(anchor), feature.observations.end());
  follow(anchor->first.camera, std::make_reverse_iterator(anchor), feature.observations.rend());
  for (const auto& [camera, last_seen] : feature.last_seen) {
    if (camera != anchor->first.camera) follow(camera, feature.observations.begin(), feature.observations.end());
  }
  return steps;
}

double imu_strain(const Window& window) {
  if (window.states().size() < 2) return 0.0;
  double sum = 0.0;
  for (const auto& factor : window.factors()) {
    if (dynamic_cast<const ImuFactor*>(factor.get()) == nullptr) continue;
    std::vector<const double*> blocks;
    for (const BlockKey& key : factor->blocks()) blocks.push_back(window.block(key));
    Eigen::Matrix<double, 15, 1> r;
    factor->Evaluate(blocks.data(), r.data(), nullptr);
    sum += r.squaredNorm();
  }
  return std::sqrt(sum / (15.0 * static_cast<double>(window.states().size() - 1)));
}

}  // namespace edged
