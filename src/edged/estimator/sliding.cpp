// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/sliding.hpp"

#include <algorithm>
#include <limits>

#include "edged/estimator/cost.hpp"
#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/marginalization.hpp"

namespace edged {
namespace {

constexpr double kRestStretch = 10.0;

/// The youngest keyframe takes over the landmarks that it still sees; its observation and later ones are kept for that.
StateId youngest_keyframe(const Window& window) {
  StateId youngest = window.oldest_id();
  for (const auto& [state, content] : window.states()) {
    if (content.keyframe) youngest = state;
  }
  return youngest;
}

/// Whether a factor goes into the prior when the oldest state leaves.
bool goes(const Factor& factor, const std::set<BlockKey>& leaving, StateId oldest) {
  if (factor.kind == FactorKind::Prior) return true;
  // It leaves with its own state, all its landmarks anchored there; others are made anew of what stays.
  if (factor.kind == FactorKind::SceneDepth) return factor.state == oldest && factor.lasting;
  return std::ranges::any_of(factor.blocks, [&](const BlockKey& key) { return leaving.contains(key); });
}

/// The terms that go into the prior when the oldest state leaves. inherited: the landmarks anchored there, and whether
/// the new_anchor goes on with them; of landmarks anchored in younger keyframes only an observation goes.
Cost cost_leaving(const Window& window, const std::set<BlockKey>& leaving, const std::map<FeatureId, bool>& inherited,
                  StateId new_anchor) {
  const StateId oldest = window.oldest_id();
  Cost cost = cost_of(window, Observations::OfKeyframes);
  std::erase_if(cost.factors, [&](const Factor& factor) { return !goes(factor, leaving, oldest); });
  std::erase_if(cost.landmarks, [&](const LandmarkTerm& term) { return term.anchor != oldest; });
  for (LandmarkTerm& term : cost.landmarks) {
    // States that are no keyframes will be dropped, not marginalised: the prior must not know them.
    if (!inherited.at(term.id)) continue;
    std::erase_if(term.residuals, [&](const LandmarkResidual& residual) { return residual.seen > new_anchor; });
  }
  return cost;
}

/// A landmark as one of its views sees it. The errors of a track are a walk, so that of its depth the view that is
/// farthest from the anchor's tells nearly all.
KeyframePoint point_of(const Window& window, FeatureId id, const Feature& feature, StateId state) {
  const SE3 T_W_A = window.T_W_C(*feature.anchor, feature.camera);
  const Eigen::Vector3d p_W = window.position(feature);
  double share = std::numeric_limits<double>::infinity();  // of the inverse depth: its sigma
  for (const auto& [other, observation] : feature.seen) {
    if (other == *feature.anchor) continue;
    const SE3 T_C_W = window.T_W_C(other, feature.camera).inverse();
    const Eigen::Vector3d p_C = T_C_W * p_W, along_C = T_C_W.R() * (p_W - T_W_A.translation());
    const Eigen::Vector2d by_share = (along_C.head<2>() - p_C.hnormalized() * along_C.z()) / p_C.z();
    share = std::min(share, observation.sigma / std::max(by_share.norm(), 1e-12));
  }
  const double inverse_depth = 1.0 / (window.T_W_C(state, feature.camera).inverse() * p_W).z();
  return {id, feature.seen.at(state).point, inverse_depth, share * std::abs(inverse_depth)};
}

/// Keyframes that stay keep what they saw of a landmark whose observations there go.
void keep_points(Window& window, FeatureId id, const Feature& feature, std::optional<StateId> new_anchor) {
  for (const auto& [state, observation] : feature.seen) {
    if (state == *feature.anchor || (new_anchor && state >= *new_anchor) || !window.states().at(state).keyframe)
      continue;
    window.keep_point(state, feature.camera, point_of(window, id, feature, state));
  }
}

KeyframeRecord record_of(const Window& window, StateId id) {
  const WindowState& state = window.states().at(id);
  KeyframeRecord record{state.t, state.T_W_B(), {}};
  for (std::size_t camera = 0; camera < window.cameras().size(); ++camera) {
    const SE3 T_B_C = record.T_W_B.inverse() * window.T_W_C(id, camera);
    const auto kept = state.kept.find(camera);
    record.views.push_back({window.cameras()[camera].given.name, T_B_C, {}});
    if (kept != state.kept.end()) record.views.back().points = kept->second;
  }
  for (const auto& [feature_id, feature] : window.features()) {
    if (!feature.anchor || !feature.seen.contains(id)) continue;
    record.views[feature.camera].points.push_back(point_of(window, feature_id, feature, id));
  }
  return record;
}

}  // namespace

void drop_or_promote(Window& window, StateId id, double max_interval_s) {
  const auto state = window.states().find(id), next = std::next(state);
  Preintegration joined = state->second.imu.joined(next->second.imu);
  const bool rested = state->second.rested && next->second.rested;
  // Where a rest begins and where it ends is worth keeping: an interval that is half of it would forget the rest.
  const bool between = state->second.rested != next->second.rested;
  if (between || joined.dt() > max_interval_s * (rested ? kRestStretch : 1.0)) {
    window.make_keyframe(id);
  } else {
    window.drop_state(id, std::move(joined));
  }
}

KeyframeRecord drop_oldest_keyframe(Window& window, const LandmarkConfig& config) {
  const StateId id = window.oldest_id(), new_anchor = youngest_keyframe(window);
  KeyframeRecord record = record_of(window, id);
  std::set<BlockKey> leaving = {{BlockKind::Pose, id}, {BlockKind::Motion, id}};
  const std::optional<BlockKey> scale = window.scale_block();
  if (scale) leaving.insert(*scale);
  std::map<FeatureId, bool> inherited;
  for (const auto& [feature_id, feature] : window.features()) {
    if (feature.anchor != id) continue;
    inherited[feature_id] = new_anchor != id && feature.seen.contains(new_anchor);
    keep_points(window, feature_id, feature, inherited[feature_id] ? std::optional(new_anchor) : std::nullopt);
  }
  Cost cost = cost_leaving(window, leaving, inherited, new_anchor);
  LinearPrior scale_walk;
  if (scale) {
    const auto next = std::next(window.states().begin());
    scale_walk = begin_scale(window, to_seconds(next->second.t - record.t));
    cost.factors.push_back(
        {FactorKind::SoftPrior, std::make_unique<LinearPriorFactor>(scale_walk), nullptr, scale_walk.blocks});
  }
  std::map<FeatureId, double> inverse_depths;  // in the new_anchor
  for (const auto& [feature_id, seen_by_heir] : inherited) {
    if (!seen_by_heir) continue;
    const Feature& feature = window.features().at(feature_id);
    const auto there = inverse_depth_in(window, new_anchor, feature.camera, window.position(feature), config);
    if (there) inverse_depths.emplace(feature_id, *there);
  }
  window.drop_oldest(marginalize(window, cost, leaving), new_anchor, inverse_depths);
  return record;
}

}  // namespace edged
