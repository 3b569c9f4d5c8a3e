// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The whole system in memory: a recording, a run through it, and how well the run did.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/io/calibration.hpp"
#include "edged/odometry.hpp"
#include "edged/sim/simulator.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// All that a data set gives, so that several runs share one reading (or rendering) of it.
struct Flight {
  Calibration calibration;
  std::vector<Measurement> measurements;
  std::optional<GroundTruth> truth;
};

/// Copies of the measurements one by one, for `drive`.
std::function<std::optional<Measurement>()> source_of(std::span<const Measurement> measurements);

Flight read_flight(Dataset& dataset, const Calibration& calibration);
Flight simulate_flight(const SimulatorConfig& config);
Flight simulate_flight(const std::string& preset, int seed, double duration_s);
/// Rendered once a process, which takes three times as long as a run: for tests that share a flight.
const Flight& shared_flight(const std::string& preset, int seed, double duration_s);

/// What one run gave.
struct FlightRun {
  std::vector<Step> steps;               ///< one a packet, without events and images
  std::vector<double> event_frame_sums;  ///< sum of grey values, one a packet; zero without an event frame
  RunStatistics statistics;
  Rig rig;                           ///< as calibrated along the way
  FinalTrajectory final_trajectory;  ///< once all steps had come
};

FlightRun run_flight(const Calibration& calibration, std::span<const Measurement> measurements, Mode mode,
                     const OdometryConfig& config = {});

/// How far a run is from the truth.
struct FlightScore {
  Evaluation evaluation;            ///< protocol P3, of the poses that edged run would write
  double max_tilt_deg = 0.0;        ///< between the estimated and the true direction of gravity in the body
  Consistency consistency;          ///< of the errors with the covariances
  double rms_velocity_error = 0.0;  ///< [m/s], in the body frame: free of yaw
};

/// Needs ground truth, and at least three poses.
FlightScore score(const Flight& flight, const FlightRun& run);

inline constexpr Mode kAllModes[] = {Mode::Events, Mode::Frames, Mode::Fused};

/// One line for a person: accuracy, scale, coverage.
std::string describe(const FlightScore& score, const RunStatistics& statistics);

}  // namespace edged
