// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Semi-dense depth of flights through a simulated room, against the true depth.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "edged/dense/dense_mapper.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/sim/renderer.hpp"
#include "edged/sim/scene.hpp"
#include "edged/sim/trajectory.hpp"
#include "end_to_end.hpp"
#include "run/dense_scan.hpp"

namespace edged {
namespace {

struct DenseRun {
  DenseMapper mapper;
  double cpu_s = 0.0, span_s = 0.0;
};

DenseRun map_densely(const Flight& flight, Mode mode) {
  const OdometryConfig config;
  const Rig used = used_cameras(flight.calibration.rig, mode, config.cameras);
  const std::vector<RigCamera> images = image_cameras(used);
  Odometry odometry(flight.calibration.rig, flight.calibration.imu, mode, config, {kInOrder});
  DenseRun run;
  std::optional<Timestamp> first;
  auto next = flight.measurements.begin();
  drive(
      odometry, [&] { return next == flight.measurements.end() ? std::nullopt : std::optional<Measurement>(*next++); },
      [&](const Step& step) {
        if (!first) first = step.t;
        run.span_s = to_seconds(step.t - *first);
        if (!is_tracking(step.status)) return true;
        DenseInstant instant = dense_instant(step, images, odometry.rig());
        const double before_s = thread_cpu_s();
        run.mapper.add(std::move(instant));
        run.cpu_s += thread_cpu_s() - before_s;
        return true;
      });
  const double before_s = thread_cpu_s();
  run.mapper.finish();
  run.cpu_s += thread_cpu_s() - before_s;
  return run;
}

/// Errors over the true depth. At the rim of an object its edge belongs to either side: of the pixel and its neighbours
/// the nearest depth counts.
std::vector<double> depth_errors(const DenseRun& run, const Simulator& simulator) {
  const Rig rig = simulator.calibration().rig;
  std::vector<double> errors;
  for (const DepthMap& map : run.mapper.maps()) {
    const RigCamera& camera = rig.camera(map.camera);
    const double t_s = to_seconds(map.t - camera.time_offset);
    Renderer renderer(map.pinhole, simulator.scene());
    const Rendering& truth = renderer.render(simulator.trajectory().at(t_s).T_W_B * camera.T_B_C, t_s);
    for (const DensePoint& point : map.points) {
      double error = std::numeric_limits<double>::max();
      for (int y = point.y - 1; y <= point.y + 1; ++y)
        for (int x = point.x - 1; x <= point.x + 1; ++x)
          error = std::min<double>(error,
                                   std::abs(truth.inverse_depth[static_cast<std::size_t>(y * map.pinhole.width() + x)] /
                                                point.inverse_depth -
                                            1.0F));
      errors.push_back(error);
    }
  }
  std::ranges::sort(errors);
  return errors;
}

TEST(DenseDepthOfARoom, AgreesWithTheTrueDepthInEveryMode) {
  SimulatorConfig config = simulator_preset("room");
  config.seed = 5;
  config.duration_s = 10.0;
  Simulator simulator(config);
  const Flight flight = read_flight(simulator, simulator.calibration());
  for (const Mode mode : kAllModes) {
    const DenseRun run = map_densely(flight, mode);
    const std::vector<double> errors = depth_errors(run, simulator);
    ASSERT_GE(errors.size(), 1000U) << mode_name(mode);
    const DenseCounters& counters = run.mapper.counters();
    const double median = errors[errors.size() / 2];
    const double outliers =
        static_cast<double>(errors.end() - std::ranges::upper_bound(errors, 0.1)) / static_cast<double>(errors.size());
    const double complete = static_cast<double>(counters.with_depth) / static_cast<double>(counters.edges);
    std::cout << fmt::format(
        "{}: {} points of {} keyframes ({} without parallax), median error {:.2f} %, {:.2f} % beyond 10 %; {:.1f} % of "
        "{} edge pixels; {:.3f} CPU s/s\n",
        mode_name(mode), errors.size(), counters.keyframes, counters.unmeasured, 100.0 * median, 100.0 * outliers,
        100.0 * complete, counters.edges, run.cpu_s / run.span_s);
    EXPECT_LE(median, 0.02) << mode_name(mode);
    EXPECT_LE(outliers, 0.05) << mode_name(mode);
    EXPECT_GE(complete, 0.6) << mode_name(mode);
  }
}

}  // namespace
}  // namespace edged
