// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "end_to_end.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <tuple>
#include <utility>

#include "edged/camera/output_frame.hpp"
#include "edged/core/check.hpp"
#include "edged/pipeline/mode.hpp"
#include "report/states_table.hpp"

namespace edged {
namespace {

/// The body's velocity in its own frame, from two poses around an instant.
Eigen::Vector3d body_velocity(const StampedPose& before, const StampedPose& after) {
  const SE3 middle = interpolate(before.T, after.T, 0.5);
  return middle.rotation().conjugate() * (after.T.translation() - before.T.translation()) /
         to_seconds(after.t - before.t);
}

}  // namespace

Flight read_flight(Dataset& dataset, const Calibration& calibration) {
  Flight flight{calibration, {}, {}};
  while (std::optional<Measurement> measurement = dataset.next()) {
    flight.measurements.push_back(std::move(*measurement));
  }
  flight.truth = dataset.ground_truth();
  return flight;
}

Flight simulate_flight(const std::string& preset, int seed, double duration_s) {
  SimulatorConfig config = simulator_preset(preset);
  config.seed = seed;
  config.duration_s = duration_s;
  return simulate_flight(config);
}

const Flight& shared_flight(const std::string& preset, int seed, double duration_s) {
  static std::map<std::tuple<std::string, int, double>, Flight> rendered;
  const auto [flight, is_new] = rendered.try_emplace({preset, seed, duration_s});
  if (is_new) flight->second = simulate_flight(preset, seed, duration_s);
  return flight->second;
}

std::function<std::optional<Measurement>()> source_of(std::span<const Measurement> measurements) {
  return [next = measurements.begin(), end = measurements.end()]() mutable {
    return next == end ? std::nullopt : std::optional<Measurement>(*next++);
  };
}

Flight simulate_flight(const SimulatorConfig& config) {
  Simulator simulator(config);
  return read_flight(simulator, simulator.calibration());
}

FlightRun run_flight(const Calibration& calibration, std::span<const Measurement> measurements, Mode mode,
                     const OdometryConfig& config) {
  Odometry odometry(calibration.rig, calibration.imu, mode, config, {kInOrder});
  FlightRun run;
  const Rig used = used_cameras(calibration.rig, mode, config.cameras);
  const auto next_measurement = [&, source = source_of(measurements)] {
    std::optional<Measurement> next = source();
    if (next) run.statistics.add_visual(*next, used);
    return next;
  };
  drive(odometry, next_measurement, [&](Step step) {
    run.statistics.add(step);
    double sum = 0.0;
    for (CameraStep& camera : step.cameras) {
      if (camera.modality == Modality::Events && !camera.image.empty()) sum += cv::sum(camera.image)[0];
      camera.image.release();
      camera.events = {}, camera.rendered = 0;
    }
    run.event_frame_sums.push_back(sum);
    run.steps.push_back(std::move(step));
    return true;
  });
  run.rig = odometry.rig();
  run.final_trajectory = odometry.final_trajectory();
  return run;
}

FlightScore score(const Flight& flight, const FlightRun& run) {
  EDGED_CHECK(flight.truth.has_value(), "the recording has no ground truth");
  const OutputFrame frame(flight.calibration.rig, flight.truth->frame);
  const Trajectory& truth = flight.truth->trajectory;
  FlightScore result;
  Trajectory estimate;
  double velocity_sum = 0.0;
  int velocities = 0;
  CovarianceSamples samples;
  for (const Step& step : run.steps) {
    samples.add(step);
    if (!is_tracking(step.status)) continue;
    estimate.push_back(step.pose_of(flight.truth->frame));
    const auto after = std::lower_bound(truth.begin(), truth.end(), estimate.back().t,
                                        [](const StampedPose& pose, Timestamp t) { return pose.t < t; });
    if (after - truth.begin() < 2 || truth.end() - after < 2) continue;
    const StampedPose before = frame.to_body(*(after - 2)), later = frame.to_body(*(after + 1));
    const SE3& T_W_B = step.state.T_W_B;
    const double share = to_seconds(step.state.t - before.t) / to_seconds(later.t - before.t);
    const SE3 true_T_W_B = interpolate(before.T, later.T, share);
    const double cosine = T_W_B.R().row(2).dot(true_T_W_B.R().row(2));
    result.max_tilt_deg = std::max(result.max_tilt_deg, std::acos(std::min(cosine, 1.0)) * 180.0 / std::numbers::pi);
    velocity_sum += (T_W_B.rotation().conjugate() * step.state.v_W - body_velocity(before, later)).squaredNorm();
    ++velocities;
  }
  result.rms_velocity_error = velocities == 0 ? 0.0 : std::sqrt(velocity_sum / velocities);
  Trajectory true_body;
  for (const StampedPose& pose : truth) true_body.push_back(frame.to_body(pose));
  result.consistency = check_consistency(true_body, samples.all());
  result.evaluation = evaluate(associate(truth, estimate), protocol("P3"));
  return result;
}

std::string describe(const FlightScore& s, const RunStatistics& statistics) {
  return fmt::format(
      "ATE {:.4f} m, mean {:.3f} %, scale {:.4f}, rotation {:.2f} deg, tilt at most {:.2f} deg, velocity {:.3f} m/s, "
      "coverage {:.3f}, lost {} times",
      s.evaluation.ate_m.rmse, s.evaluation.mpe_percent, s.evaluation.scale, s.evaluation.rotation_deg.mean,
      s.max_tilt_deg, s.rms_velocity_error, statistics.coverage(), statistics.times_lost());
}

}  // namespace edged
