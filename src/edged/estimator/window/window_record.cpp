// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The window of a whole start.
#include <algorithm>
#include <cmath>
#include <set>

#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/start_record.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {

Window::Window(const StartRecord& record)
    : cameras_(record.cameras),
      imu_intrinsics_(record.imu_intrinsics),
      prior_(std::make_shared<LinearPriorFactor>(LinearPrior{})),
      track_noise_(record.track_noise),
      depth_config_(record.depth_config) {
  for (const StartRecord::State& kept : record.states) {
    const WindowState& state = states_.emplace_hint(states_.end(), kept.id, kept.state)->second;
    if (states_.size() == 1) continue;
    const auto before = std::prev(states_.end(), 2);
    auto imu = std::make_shared<ImuFactor>(before->first, kept.id, state.imu);
    imu->set_noise_scale(record.states[states_.size() - 2].imu_noise_scale);
    factors_.push_back(std::move(imu));
  }
  for (const auto& [key, value] : record.parameters) {
    const auto [parameter, is_new] = parameters_.try_emplace(key.kind, key.kind, key.id, value, 0.0);
    if (!is_new) parameter->second.blocks().emplace(key.id, value);
  }
  // No state is dropped nor any parameter propagated any more: factors do not change.
  for (const auto& factor : record.factors) factors_.push_back(std::const_pointer_cast<Factor>(factor));
  remove_orphaned_factors();
  std::map<FeatureId, std::size_t> begins;  // place of the first state that observes it
  for (std::size_t part = 0; part < record.parts.size(); ++part) observe_again(record, part, begins);
  std::erase_if(features_, [](const auto& entry) { return !entry.second.anchor; });
  next_state_ = states_.empty() ? 0 : newest_id() + 1;
}

/// The observations of a part, and the landmark by its newest part, anchored in its first observation by a keyframe. A
/// track that lasts longer than the band of the equations becomes another landmark: it would couple all of its states.
void Window::observe_again(const StartRecord& record, std::size_t index, std::map<FeatureId, std::size_t>& begins) {
  constexpr FeatureId kNextLandmark = FeatureId{1} << 40U;  // beyond the ids of all features
  const StartRecord::Part& part = record.parts[index];
  const std::size_t end = index + 1 < record.parts.size() ? record.parts[index + 1].first : record.observations.size();
  std::set<FeatureId> observed;
  for (std::size_t i = part.first; i < end; ++i) {
    const auto& [state, camera, point, sigma] = record.observations[i];
    const auto at = std::ranges::lower_bound(record.states, StateId{state}, {}, &StartRecord::State::id);
    if (at == record.states.end() || at->id != state) continue;
    const auto place = static_cast<std::size_t>(at - record.states.begin());
    const std::size_t begin = begins.try_emplace(part.id, place).first->second;
    const FeatureId id = part.id + kNextLandmark * ((std::max(place, begin) - begin) / kSolverTuning.band_states);
    observed.insert(id);
    Feature& feature = features_[id];
    const ObservationKey image{state, camera};
    WindowObservation& kept =
        feature.observations.insert_or_assign(image, WindowObservation{{id, point.cast<double>(), sigma}, {}, false})
            .first->second;
    linearise(cameras_[camera], kept);
    StateId& last = feature.last_seen[camera];
    last = std::max(last, image.state);
  }
  for (const FeatureId id : observed) anchor_at(features_.at(id), part.p_O.cast<double>());
}

/// The feature becomes a landmark at that place, if it is observed twice.
void Window::anchor_at(Feature& feature, const Eigen::Vector3d& p_O) const {
  feature.anchor.reset();
  if (feature.observations.size() < 2) return;
  for (const auto& [image, observation] : feature.observations) {
    if (!states_.at(image.state).keyframe) continue;
    const double inverse_depth = 1.0 / (T_O_C(image).inverse() * p_O).z();
    if (!std::isfinite(inverse_depth)) return;
    feature.anchor = image;
    feature.inverse_depth = inverse_depth;
    return;
  }
}

}  // namespace edged
