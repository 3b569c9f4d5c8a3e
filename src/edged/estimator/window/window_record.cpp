// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The window of a whole start.
#include <cmath>

#include "edged/estimator/factors/imu_factor.hpp"
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
  for (std::size_t part = 0; part < record.parts.size(); ++part) observe_again(record, part);
  std::erase_if(features_, [](const auto& entry) { return !entry.second.anchor; });
  next_state_ = states_.empty() ? 0 : newest_id() + 1;
}

/// The observations of a part, and the landmark by its newest part, anchored in its first observation by a keyframe.
void Window::observe_again(const StartRecord& record, std::size_t index) {
  const StartRecord::Part& part = record.parts[index];
  const std::size_t end = index + 1 < record.parts.size() ? record.parts[index + 1].first : record.observations.size();
  Feature& feature = features_[part.id];
  for (std::size_t i = part.first; i < end; ++i) {
    const auto& [state, camera, point, sigma] = record.observations[i];
    if (!states_.contains(state)) continue;
    const ObservationKey image{state, camera};
    WindowObservation& kept =
        feature.observations
            .insert_or_assign(image, WindowObservation{{part.id, point.cast<double>(), sigma}, {}, false})
            .first->second;
    linearise(cameras_[camera], kept);
    StateId& last = feature.last_seen[camera];
    last = std::max(last, image.state);
  }
  feature.anchor.reset();
  if (feature.observations.size() < 2) return;
  for (const auto& [image, observation] : feature.observations) {
    if (!states_.at(image.state).keyframe) continue;
    const double inverse_depth = 1.0 / (T_O_C(image).inverse() * part.p_O.cast<double>()).z();
    if (!std::isfinite(inverse_depth)) return;
    feature.anchor = image;
    feature.inverse_depth = inverse_depth;
    return;
  }
}

}  // namespace edged
