// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A stereo pair of simulated cameras: a rig with two event cameras and two frame cameras.
#pragma once

#include <memory>
#include <optional>

#include "edged/sim/simulator.hpp"

namespace edged {

/// "events", "frames" and the IMU have the same bits as those of Simulator. "events2" and "frames2" are to the right of
/// them, with independent noise.
class SimulatedPair final : public Dataset {
 public:
  static constexpr double kUsualBaseline_m = 0.1;

  explicit SimulatedPair(const SimulatorConfig& config, double baseline_m = kUsualBaseline_m);

  const DatasetInfo& info() const override { return info_; }
  std::optional<Measurement> next() override;
  void leave_out(Modality unwanted) override;
  std::optional<GroundTruth> ground_truth() const override { return left_.ground_truth(); }

  Calibration calibration() const;

 private:
  std::optional<Measurement> take_right();

  Simulator left_, right_;
  DatasetInfo info_;
  std::optional<Measurement> of_left_, of_right_;  // the next ones
};

}  // namespace edged
