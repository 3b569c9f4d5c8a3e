// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/cost.hpp"

#include <cmath>
#include <iterator>

#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/standstill_factor.hpp"

namespace edged {
namespace {

// What is called rest may be this far from it, whatever the time between the two states.
constexpr double kRestSigma_m = 2e-3, kRestSigma_rad = 1e-3;

void add_motion_factors(const Window& window, std::vector<Factor>& out) {
  if (window.states().empty()) return;
  for (auto b = std::next(window.states().begin()); b != window.states().end(); ++b) {
    const BlockKey pose_a{BlockKind::Pose, std::prev(b)->first}, pose_b{BlockKind::Pose, b->first};
    const BlockKey motion_a{BlockKind::Motion, pose_a.id}, motion_b{BlockKind::Motion, pose_b.id};
    out.push_back({FactorKind::Imu,
                   std::make_unique<ImuFactor>(b->second.imu),
                   nullptr,
                   {pose_a, motion_a, pose_b, motion_b, kImuIntrinsicsKey}});
    if (!b->second.rested) continue;
    out.push_back({FactorKind::Standstill,
                   std::make_unique<StandstillFactor>(kRestSigma_m, kRestSigma_rad),
                   nullptr,
                   {pose_a, pose_b}});
  }
}

/// The inverse depths that factors hold: each ties several together.
std::set<FeatureId> coupled_depths(const std::vector<Factor>& factors) {
  std::set<FeatureId> coupled;
  for (const Factor& factor : factors) {
    for (const BlockKey& key : factor.blocks) {
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
    const StateId anchor = *feature.anchor;
    LandmarkTerm term{id,
                      feature.camera,
                      anchor,
                      place.at(anchor),
                      feature.seen.at(anchor).point,
                      &feature.inverse_depth,
                      coupled.contains(id),
                      {}};
    for (const TrackStep& step : track_steps(window, feature, observations)) {
      const double correlation = step.before == anchor ? 0.0 : step.correlation;
      term.residuals.push_back(
          {step.seen, place.at(step.seen), feature.seen.at(step.seen).point, correlation, 1.0 / step.sigma});
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

}  // namespace

Cost cost_of(const Window& window, Observations observations) {
  Cost cost;
  const auto add_prior = [&](FactorKind kind, const LinearPrior& prior) {
    cost.factors.push_back({kind, std::make_unique<LinearPriorFactor>(prior), nullptr, prior.blocks});
  };
  if (!window.prior().empty()) add_prior(FactorKind::Prior, window.prior());
  for (const LinearPrior& soft : window.soft_priors()) add_prior(FactorKind::SoftPrior, soft);
  add_motion_factors(window, cost.factors);
  add_depth_factors(window, cost.factors);
  cost.landmarks = landmark_terms(window, observations, coupled_depths(cost.factors));
  return cost;
}

std::set<BlockKey> blocks_of(const Cost& cost) {
  std::set<BlockKey> blocks;
  for (const Factor& factor : cost.factors) blocks.insert(factor.blocks.begin(), factor.blocks.end());
  for (const LandmarkTerm& term : cost.landmarks) {
    if (term.coupled) blocks.insert({BlockKind::InverseDepth, term.id});
    if (term.residuals.empty()) continue;
    blocks.insert({BlockKind::Pose, term.anchor});
    blocks.insert({BlockKind::Calibration, term.camera});
    for (const LandmarkResidual& residual : term.residuals) blocks.insert({BlockKind::Pose, residual.seen});
  }
  return blocks;
}

std::vector<TrackStep> track_steps(const Window& window, const Feature& feature, Observations observations) {
  std::vector<TrackStep> steps;
  const auto anchor = feature.seen.find(*feature.anchor);
  const double at_once = window.track_noise().of(window.cameras()[feature.camera].given.modality);
  const auto follow = [&](auto first, auto last) {
    StateId before = anchor->first;
    for (auto observation = first; observation != last; ++observation) {
      if (observations == Observations::OfKeyframes && !window.states().at(observation->first).keyframe) continue;
      const double dt = std::abs(to_seconds(window.states().at(observation->first).t - window.states().at(before).t));
      const double correlation = at_once * std::exp(-dt / window.track_noise().time_s);
      const double own = std::sqrt(1.0 - correlation * correlation);
      steps.push_back({before, observation->first, correlation, observation->second.sigma * own});
      before = observation->first;
    }
  };
  follow(std::next(anchor), feature.seen.end());
  follow(std::make_reverse_iterator(anchor), feature.seen.rend());
  return steps;
}

double imu_strain(const Window& window) {
  if (window.states().size() < 2) return 0.0;
  double sum = 0.0;
  for (auto a = window.states().begin(), b = std::next(a); b != window.states().end(); ++a, ++b) {
    const double* blocks[] = {a->second.pose.data(), a->second.motion.data(), b->second.pose.data(),
                              b->second.motion.data(), window.block(kImuIntrinsicsKey)};
    Eigen::Matrix<double, 15, 1> r;
    ImuFactor(b->second.imu).Evaluate(blocks, r.data(), nullptr);
    sum += r.squaredNorm();
  }
  return std::sqrt(sum / (15.0 * static_cast<double>(window.states().size() - 1)));
}

}  // namespace edged
