// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// External sensors of the simulator: a barometer and a wheel or flow sensor, with their errors.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "edged/config.hpp"
#include "edged/core/external_sensor.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

/// The errors of any of them, in the unit of the sensor.
struct ExternalErrors {
  double rate_hz = 0.0;        ///< 0: there is no such sensor
  double noise = 0.0;          ///< standard deviation of a sample
  double walk = 0.0;           ///< random walk of the offset, per square root of a second
  double scale_error = 0.0;    ///< reads (1 + scale_error) times the truth
  double outlier_share = 0.0;  ///< of the samples
  double outlier = 0.0;        ///< standard deviation of these
  double gap_at_s = 0.0, gap_s = 0.0;
  double late_ms = 0.0;  ///< stamped so long after they were measured

  void visit(ConfigFields& fields, const char* unit);
};

/// A barometer at 25 Hz has errors of 0.1 m.
struct HeightModelConfig {
  ExternalErrors errors{.noise = 0.1, .outlier = 5.0};
  double zero_m = 0.0;  ///< reads this at the origin
  void visit(ConfigFields& fields);
};

/// Its axes are those of the body.
struct VelocityModelConfig {
  ExternalErrors errors{.noise = 0.05, .outlier = 2.0};
  Eigen::Vector3d p_B_S = Eigen::Vector3d::Zero();  ///< where it sits [m]
  void visit(ConfigFields& fields);
};

struct ExternalModelConfig {
  HeightModelConfig height;
  VelocityModelConfig velocity;
};

/// One of them: its samples in the order of their stamps. Each has random numbers of its own, so other sensors do not
/// change.
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
