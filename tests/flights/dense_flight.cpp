// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dense_flight.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "edged/pipeline/mode.hpp"
#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/scene/scene.hpp"
#include "edged/sim/sensors/renderer.hpp"
#include "scene/dense_scan.hpp"

namespace edged {
namespace {

double depth_error(const DensePoint& point, const Rendering& truth, int width) {
  double error = std::numeric_limits<double>::max();
  for (int y = point.y - 1; y <= point.y + 1; ++y) {
    for (int x = point.x - 1; x <= point.x + 1; ++x) {
      const float true_inverse = truth.inverse_depth[static_cast<std::size_t>(y * width + x)];
      error = std::min<double>(error, std::abs(true_inverse / point.inverse_depth - 1.0F));
    }
  }
  return error;
}

}  // namespace

DenseRun map_densely(const Flight& flight, Mode mode, const OdometryConfig& config) {
  const Rig used = used_cameras(flight.calibration.rig, mode, config.cameras);
  const std::vector<RigCamera> images = image_cameras(used);
  Odometry odometry(flight.calibration.rig, flight.calibration.imu, mode, config, {kInOrder});
  DenseRun run;
  std::optional<Timestamp> first;
  drive(odometry, source_of(flight.measurements), [&](const Step& step) {
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

DenseScore score(const DenseRun& run, const SimulatorConfig& truth) {
  const Simulator simulator(truth);
  const Rig rig = simulator.calibration().rig;
  std::vector<double> errors;
  for (const DepthMap& map : run.mapper.maps()) {
    const RigCamera& camera = rig.camera(map.camera);
    const double t_s = to_seconds(map.t - camera.time_offset);
    Renderer renderer(map.pinhole, simulator.scene());
    const Rendering& rendering = renderer.render(simulator.trajectory().at(t_s).T_W_B * camera.T_B_C, t_s);
    for (const DensePoint& point : map.points) errors.push_back(depth_error(point, rendering, map.pinhole.width()));
  }
  const DenseCounters& counters = run.mapper.counters();
  DenseScore score{.points = errors.size(), .load = run.cpu_s / run.span_s};
  if (counters.edges > 0)
    score.complete = static_cast<double>(counters.with_depth) / static_cast<double>(counters.edges);
  if (errors.empty()) return score;
  std::ranges::sort(errors);
  score.median_error = errors[errors.size() / 2];
  score.outliers =
      static_cast<double>(errors.end() - std::ranges::upper_bound(errors, 0.1)) / static_cast<double>(errors.size());
  return score;
}

std::string describe(const DenseRun& run, const DenseScore& score) {
  const DenseCounters& counters = run.mapper.counters();
  return fmt::format(
      "{} points of {} keyframes ({} without parallax), median error {:.2f} %, {:.2f} % beyond 10 %; "
      "{:.1f} % of {} edge pixels; {:.3f} CPU s/s",
      score.points, counters.keyframes, counters.unmeasured, 100.0 * score.median_error, 100.0 * score.outliers,
      100.0 * score.complete, counters.edges, score.load);
}

}  // namespace edged
