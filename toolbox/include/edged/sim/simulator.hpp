// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Event camera, frames and IMU moving through a textured scene, with the truth: a Dataset like any recording.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "edged/dataset.hpp"
#include "edged/io/calibration_data.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

// Types of the library itself.
class DisturbedTrajectory;
struct Scene;

/// Deterministic by config and seed. Renders as next() is called; holds the measurements of one exposure at most.
/// Stamps start at 0 on the camera's clock; motion.rest_s from there are at rest. Cameras "events" and "frames", with
/// the suffix of its mount.
class Simulator : public Dataset {
 public:
  /// Throws InputError for impossible values, or a motion file that is missing or too short.
  explicit Simulator(const SimulatorConfig& config);
  Simulator(Simulator&& other) noexcept;
  Simulator& operator=(Simulator&& other) noexcept;
  ~Simulator() override;

  const DatasetInfo& info() const override;
  std::optional<Measurement> next() override;
  /// Leaves out events alone: frames cost little beside the pictures.
  void leave_out(Modality unwanted) override;
  /// T_W_B at 200 Hz, stamps on the IMU's clock.
  std::optional<GroundTruth> ground_truth() const override;

  Calibration calibration() const;

  /// The exact motion; t: seconds on the camera's clock.
  const DisturbedTrajectory& trajectory() const;
  /// What has been rendered so far: how many pictures, and the last one's time on the camera's clock.
  std::size_t renderings() const;
  Timestamp rendered_until() const;
  /// The scene.
  const Scene& scene() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace edged
