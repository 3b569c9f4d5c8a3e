// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/start_record.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {

void StartRecord::add_oldest(const Window& window, std::span<const std::shared_ptr<const Factor>> leaving,
                             const std::map<FeatureId, NewAnchor>& inherited) {
  const StateId oldest = window.oldest_id();
  add_state(window, oldest);
  add_factors(leaving);
  add_parameters(window);
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    const auto new_anchor = inherited.find(id);
    const bool ends = feature.anchor->state == oldest && new_anchor == inherited.end();
    const StateId until = new_anchor != inherited.end() ? new_anchor->second.key.state
                          : ends                        ? window.newest_id() + 1
                                                        : oldest + 1;
    add_observations(window, id, feature, [&](StateId state) {
      return state < until && (state == oldest || window.states().at(state).keyframe);
    });
  }
}

void StartRecord::close(const Window& window) {
  for (const auto& [id, state] : window.states()) add_state(window, id);
  std::vector<std::shared_ptr<const Factor>> all(window.soft_priors().begin(), window.soft_priors().end());
  all.insert(all.end(), window.factors().begin(), window.factors().end());
  add_factors(all);
  add_parameters(window);
  for (const auto& [id, feature] : window.features())
    if (feature.anchor) add_observations(window, id, feature, [](StateId) { return true; });
  cameras = window.cameras();
  std::copy_n(window.block(kImuIntrinsicsKey), imu_intrinsics.size(), imu_intrinsics.begin());
  track_noise = window.track_noise();
  depth_config = window.depth_config();
}

void StartRecord::add_state(const Window& window, StateId id) {
  EDGED_CHECK(empty() || states.back().id < id, "state {} after {}", id, states.back().id);
  WindowState state = window.states().at(id);
  state.imu = state.imu.without_samples();
  state.marginalized_points.clear();
  states.push_back({id, std::move(state), window.imu_noise_scale()});
}

/// IMU factors follow from the states, depth factors from landmarks.
void StartRecord::add_factors(std::span<const std::shared_ptr<const Factor>> leaving) {
  for (const auto& factor : leaving) {
    const bool follows =
        dynamic_cast<const ImuFactor*>(factor.get()) != nullptr ||
        std::ranges::any_of(factor->blocks(), [](const BlockKey& key) { return key.kind == BlockKind::InverseDepth; });
    if (!follows) factors.push_back(factor);
  }
}

void StartRecord::add_parameters(const Window& window) {
  for (const BlockKey& key : window.parameters()) parameters.push_back({key, *window.block(key)});
}

void StartRecord::add_observations(const Window& window, FeatureId id, const Feature& track,
                                   const std::function<bool(StateId)>& leaves) {
  const std::size_t before = observations.size();
  for (const auto& [view, observation] : track.observations) {
    if (!leaves(view.state)) continue;
    const auto state = static_cast<std::uint32_t>(view.state);
    observations.push_back({state, static_cast<std::uint32_t>(view.camera), observation.point.cast<float>(),
                            static_cast<float>(observation.sigma)});
  }
  if (observations.size() == before) return;
  parts.push_back({id, window.position(track).cast<float>(), static_cast<std::uint32_t>(before)});
}

}  // namespace edged
