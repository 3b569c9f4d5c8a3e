// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// All measurements of one start of the estimator, kept as they leave its window: what the prior of marginalization
// sums up, one by one. From it a window with all keyframes is made, for the final optimization.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "edged/estimator/window/window.hpp"

namespace edged {

struct StartRecord {
  struct State {
    StateId id;
    WindowState state;           ///< its IMU interval without samples
    double imu_noise_scale = 1;  ///< of the interval that follows
  };
  struct Observation {
    std::uint32_t state;  ///< index
    std::uint32_t camera;
    Eigen::Vector2f point;  ///< as FeatureObservation's
    float sigma;
  };
  /// Observations of a landmark that have left together.
  struct Part {
    FeatureId id;
    Eigen::Vector3f p_O;  ///< the landmark as known then
    std::uint32_t first;  ///< of its observations; they last until the next part's first
  };
  struct Parameter {
    BlockKey key;
    double value;
  };

  bool empty() const { return states.empty(); }

  /// The oldest state of the window is about to be marginalized, with these factors; inherited: new anchors.
  void add_oldest(const Window& window, std::span<const std::shared_ptr<const Factor>> leaving,
                  const std::map<FeatureId, NewAnchor>& inherited);
  /// All that the window still has. Nothing can be added after that.
  void close(const Window& window);

  std::vector<State> states;
  std::vector<Observation> observations;
  std::vector<Part> parts;
  std::vector<std::shared_ptr<const Factor>> factors;  ///< without those that follow from the states
  std::vector<Parameter> parameters;
  // What the window had when it was closed.
  std::vector<WindowCamera> cameras;
  ImuIntrinsicsBlock imu_intrinsics{};
  TrackNoise track_noise;
  DepthFactorConfig depth_config;

 private:
  void add_state(const Window& window, StateId id);
  void add_factors(std::span<const std::shared_ptr<const Factor>> leaving);
  void add_parameters(const Window& window);
  void add_observations(const Window& window, FeatureId id, const Feature& track,
                        const std::function<bool(StateId)>& leaves);
};

}  // namespace edged
