// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/cost.hpp"

#include <algorithm>
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
  if (window.states.empty()) return;
  for (auto b = std::next(window.states.begin()); b != window.states.end(); ++b) {
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

void add_visual_factors(Window& window, Observations observations, std::vector<Factor>& out) {
  for (const auto& [id, feature] : window.features) {
    if (!feature.anchor) continue;
    const auto view = [&](StateId state) {
      return LandmarkView{feature.seen.at(state).point, window.states.at(state).rate()};
    };
    const auto pose = [](StateId state) { return BlockKey{BlockKind::Pose, state}; };
    const BlockKey calib{BlockKind::Calibration, feature.camera}, depth{BlockKind::InverseDepth, id};
    const SE3& T_B_C = window.cameras[feature.camera].T_B_C;
    const StateId anchor = *feature.anchor;
    const LandmarkView from = view(anchor);
    for (const TrackStep& step : track_steps(window, feature, observations)) {
      Factor factor{FactorKind::Observation, nullptr, window.visual_loss(), {pose(anchor), pose(step.seen)}};
      factor.state = step.seen;
      factor.landmark = id;
      // The anchor's observation is exact by the choice of the landmark: the first step has no error to start from.
      if (step.before == anchor || step.correlation == 0.0) {
        factor.cost = std::make_unique<ReprojectionFactor>(T_B_C, from, view(step.seen), step.sigma);
      } else {
        factor.cost = std::make_unique<TrackStepFactor>(T_B_C, from, view(step.seen), view(step.before),
                                                        step.correlation, step.sigma);
        factor.blocks.push_back(pose(step.before));
      }
      factor.blocks.insert(factor.blocks.end(), {calib, depth});
      out.push_back(std::move(factor));
    }
  }
}

}  // namespace

std::vector<Factor> factors_of(Window& window, Observations observations) {
  std::vector<Factor> out;
  if (!window.prior.empty())
    out.push_back({FactorKind::Prior, std::make_unique<LinearPriorFactor>(window.prior), nullptr, window.prior.blocks});
  for (const LinearPrior& soft : window.soft_priors) {
    out.push_back({FactorKind::SoftPrior, std::make_unique<LinearPriorFactor>(soft), nullptr, soft.blocks});
  }
  add_motion_factors(window, out);
  add_visual_factors(window, observations, out);
  add_depth_factors(window, out);
  return out;
}

std::vector<TrackStep> track_steps(const Window& window, const Feature& feature, Observations observations) {
  std::vector<TrackStep> steps;
  const auto anchor = feature.seen.find(*feature.anchor);
  const double at_once = window.track_noise.of(window.cameras[feature.camera].modality);
  const auto follow = [&](auto first, auto last) {
    StateId before = anchor->first;
    for (auto observation = first; observation != last; ++observation) {
      if (observations == Observations::OfKeyframes && !window.states.at(observation->first).keyframe) continue;
      const double dt = std::abs(to_seconds(window.states.at(observation->first).t - window.states.at(before).t));
      const double correlation = at_once * std::exp(-dt / window.track_noise.time_s);
      const double own = std::sqrt(1.0 - correlation * correlation);
      steps.push_back({before, observation->first, correlation, observation->second.sigma * own});
      before = observation->first;
    }
  };
  follow(std::next(anchor), feature.seen.end());
  follow(std::make_reverse_iterator(anchor), feature.seen.rend());
  return steps;
}

std::set<BlockKey> coupled_depths(const std::vector<Factor>& factors) {
  std::set<BlockKey> coupled;
  for (const Factor& factor : factors) {
    const auto is_depth = [](const BlockKey& key) { return key.kind == BlockKind::InverseDepth; };
    if (std::count_if(factor.blocks.begin(), factor.blocks.end(), is_depth) < 2) continue;
    std::copy_if(factor.blocks.begin(), factor.blocks.end(), std::inserter(coupled, coupled.end()), is_depth);
  }
  return coupled;
}

double imu_strain(const Window& window) {
  if (window.states.size() < 2) return 0.0;
  double sum = 0.0;
  for (auto a = window.states.begin(), b = std::next(a); b != window.states.end(); ++a, ++b) {
    const double* blocks[] = {a->second.pose.data(), a->second.motion.data(), b->second.pose.data(),
                              b->second.motion.data(), window.imu_intrinsics.data()};
    Eigen::Matrix<double, 15, 1> r;
    ImuFactor(b->second.imu).Evaluate(blocks, r.data(), nullptr);
    sum += r.squaredNorm();
  }
  return std::sqrt(sum / (15.0 * static_cast<double>(window.states.size() - 1)));
}

}  // namespace edged
