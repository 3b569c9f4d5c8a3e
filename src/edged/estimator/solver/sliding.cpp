// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/sliding.hpp"

#include <algorithm>
#include <limits>

#include "edged/estimator/solver/marginalization.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {
namespace {

/// The youngest keyframe becomes the new anchor of landmarks that it observes; its observation and later ones are kept
/// for that.
StateId youngest_keyframe(const Window& window) {
  StateId youngest = window.oldest_id();
  for (const auto& [state, content] : window.states()) {
    if (content.keyframe) youngest = state;
  }
  return youngest;
}

/// The landmarks anchored in the oldest state, and the observation that becomes the new anchor of those that the
/// youngest keyframe observes: that of the same camera if there is one.
using Inherited = std::map<FeatureId, std::optional<ObservationKey>>;

Inherited inherited_landmarks(const Window& window) {
  const StateId oldest = window.oldest_id(), youngest = youngest_keyframe(window);
  Inherited inherited;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor || feature.anchor->state != oldest) continue;
    std::optional<ObservationKey>& anchor = inherited[id];
    if (youngest == oldest || !feature.seen_at(youngest)) continue;
    anchor = feature.observations.lower_bound({youngest, 0})->first;
    const ObservationKey same_camera{youngest, feature.anchor->camera};
    if (feature.observations.contains(same_camera)) anchor = same_camera;
  }
  return inherited;
}

/// The terms that go into the prior when the oldest state is marginalized. Landmarks anchored in younger keyframes lose
/// only an observation; of those with a new anchor, the observations before it are marginalized.
Cost cost_leaving(const Window& window, const std::set<BlockKey>& leaving, const Inherited& inherited) {
  const StateId oldest = window.oldest_id();
  // States that are no keyframes will be dropped, not marginalized: the prior must not depend on them.
  Cost cost = cost_of(window, Observations::OfKeyframes);
  std::erase_if(cost.factors, [&](const auto& factor) { return !factor->marginalized_with(leaving); });
  std::erase_if(cost.landmarks, [&](const LandmarkTerm& term) { return term.anchor.state != oldest; });
  for (LandmarkTerm& term : cost.landmarks) {
    const std::optional<ObservationKey>& anchor = inherited.at(term.id);
    if (!anchor) continue;
    std::erase_if(term.residuals, [&](const LandmarkResidual& residual) {
      return residual.seen.state >= anchor->state && residual.seen != *anchor;
    });
  }
  return cost;
}

/// A landmark in one of its views, at the point by the given intrinsics. The errors of a track are a random walk, so
/// the view farthest from the anchor has almost all information on its depth.
KeyframePoint point_of(const Window& window, FeatureId id, const Feature& feature, const ObservationKey& view) {
  const SE3 T_O_A = window.T_O_C(*feature.anchor);
  const Eigen::Vector3d p_O = window.position(feature);
  double share = std::numeric_limits<double>::infinity();  // sigma of the inverse depth, as a share of it
  for (const auto& [other, observation] : feature.observations) {
    if (other == *feature.anchor) continue;
    const SE3 T_C_O = window.T_O_C(other).inverse();
    const Eigen::Vector3d p_C = T_C_O * p_O, along_C = T_C_O.R() * (p_O - T_O_A.translation());
    const Eigen::Vector2d by_share = (along_C.head<2>() - p_C.hnormalized() * along_C.z()) / p_C.z();
    share = std::min(share, observation.sigma / std::max(by_share.norm(), 1e-12));
  }
  const double inverse_depth = 1.0 / (window.T_O_C(view).inverse() * p_O).z();
  return {id, feature.observations.at(view).point, inverse_depth, share * std::abs(inverse_depth)};
}

/// Remaining keyframes keep a record of a landmark whose observations there are marginalized.
void keep_marginalized_points(Window& window, FeatureId id, const Feature& feature,
                              const std::optional<ObservationKey>& anchor) {
  for (const auto& [view, observation] : feature.observations) {
    if (view.state == feature.anchor->state || (anchor && view.state >= anchor->state)) continue;
    if (window.states().at(view.state).keyframe)
      window.add_marginalized_point(view, point_of(window, id, feature, view));
  }
}

/// All points of a view by the intrinsics that belong to its T_B_C: some were kept when the estimates were others, and
/// a shift of the principal point is a rotation of the camera.
void correct_points(const Window& window, MarginalizedKeyframe& record) {
  for (std::size_t camera = 0; camera < record.views.size(); ++camera) {
    const WindowCamera& by = window.cameras()[camera];
    if (by.intrinsics().isZero(0.0)) continue;
    const CameraModel model = by.model();
    for (KeyframePoint& point : record.views[camera].points) point.point = point_by(model, by.given.model, point.point);
  }
}

MarginalizedKeyframe record_of(const Window& window, StateId id) {
  const WindowState& state = window.states().at(id);
  MarginalizedKeyframe record{state.t, state.T_O_B(), {}};
  for (std::size_t camera = 0; camera < window.cameras().size(); ++camera) {
    const SE3 T_B_C = record.T_O_B.inverse() * window.T_O_C({id, camera});
    const auto kept = state.marginalized_points.find(camera);
    record.views.push_back({window.cameras()[camera].given.name, T_B_C, {}});
    if (kept != state.marginalized_points.end()) record.views.back().points = kept->second;
  }
  for (const auto& [feature_id, feature] : window.features()) {
    if (!feature.anchor) continue;
    for (auto seen = feature.observations.lower_bound({id, 0});
         seen != feature.observations.end() && seen->first.state == id; ++seen) {
      record.views[seen->first.camera].points.push_back(point_of(window, feature_id, feature, seen->first));
    }
  }
  correct_points(window, record);
  return record;
}

}  // namespace

void drop_or_promote(Window& window, StateId id, double max_interval_s) {
  const auto state = window.states().find(id), next = std::next(state);
  Preintegration joined = state->second.imu.joined(next->second.imu);
  const bool stationary = state->second.stationary && next->second.stationary;
  // The begin and the end of a standstill are kept: an interval joined across one would lose the standstill factor.
  const bool between = state->second.stationary != next->second.stationary;
  if (between || joined.dt() > max_interval_s * (stationary ? kSolverTuning.rest_stretch : 1.0)) {
    window.make_keyframe(id);
  } else {
    window.drop_state(id, std::move(joined));
  }
}

MarginalizedKeyframe drop_oldest_keyframe(Window& window, const LandmarkConfig& config, StartRecord* all) {
  const StateId id = window.oldest_id();
  MarginalizedKeyframe record = record_of(window, id);
  std::set<BlockKey> leaving = {{BlockKind::Pose, id}, {BlockKind::Motion, id}};
  for (const BlockKey& parameter : window.parameters()) leaving.insert(parameter);
  const Inherited inherited = inherited_landmarks(window);
  for (const auto& [feature_id, anchor] : inherited) {
    keep_marginalized_points(window, feature_id, window.features().at(feature_id), anchor);
  }
  Cost cost = cost_leaving(window, leaving, inherited);
  std::map<FeatureId, NewAnchor> anchors;
  for (const auto& [feature_id, anchor] : inherited) {
    if (!anchor) continue;
    const auto there = inverse_depth_in(window, *anchor, window.position(window.features().at(feature_id)), config);
    if (there) anchors.emplace(feature_id, NewAnchor{*anchor, *there});
  }
  if (all != nullptr) all->add_oldest(window, cost.factors, anchors);
  const double dt_s = to_seconds(std::next(window.states().begin())->second.t - record.t);
  for (const BlockKey& parameter : window.parameters()) {
    cost.factors.push_back(std::make_shared<LinearPriorFactor>(window.propagate_parameter(parameter.kind, dt_s)));
    if (all != nullptr) all->factors.push_back(cost.factors.back());
  }
  window.drop_oldest(marginalize(window, cost, leaving), anchors);
  return record;
}

std::vector<MarginalizedKeyframe> keyframe_records(const Window& window) {
  std::vector<MarginalizedKeyframe> records;
  for (const auto& [id, state] : window.states())
    if (state.keyframe) records.push_back(record_of(window, id));
  return records;
}

void marginalize_parameter(Window& window, BlockKind kind) {
  std::set<BlockKey> leaving;
  for (const BlockKey& key : window.prior()->blocks()) {
    if (key.kind == kind) leaving.insert(key);
  }
  const Cost known{window.prior(), {}, {}};
  window.remove_parameter(kind, leaving.empty() ? window.prior()->prior() : marginalize(window, known, leaving));
}

}  // namespace edged
