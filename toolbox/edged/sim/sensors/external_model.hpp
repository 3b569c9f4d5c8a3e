// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// External sensors of the simulator: a barometer and a wheel or flow sensor, with their errors.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// One external sensor, with samples in the order of their stamps. It has its own random numbers, so it does not change
/// other sensors.
class ExternalModel {
 public:
  /// index: of the sensor in ExternalSample. shift: from the camera's clock to the stamps.
  ExternalModel(const ExternalModelConfig& config, std::size_t index, std::uint64_t seed, Duration shift);

  /// The next sample, measured before end_s on the camera's clock; nothing after that.
  template <typename Motion>
  const std::optional<ExternalSample>& peek(const Motion& motion, double end_s) {
    while (!next_ && sample_s() < end_s) {
      next_ = measure(motion.at(sample_s()));
      ++count_;
    }
    return next_;
  }
  ExternalSample pop() { return *std::exchange(next_, std::nullopt); }

 private:
  double sample_s() const;
  std::optional<ExternalSample> measure(const Kinematics& truth);
  ExternalNumbers true_numbers(const Kinematics& truth) const;

  ExternalModelConfig config_;
  std::size_t index_;
  ExternalErrors errors_;
  Duration shift_;
  Random random_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  std::int64_t count_ = 0;
  std::optional<ExternalSample> next_;
};

}  // namespace edged
