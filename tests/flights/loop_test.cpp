// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A walk round a block of corridors, with the errors of cheap sensors: the loop is closed by appearance. So short a
// walk drifts by less than matches by position bridge, so these are narrowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>
#include <numeric>
#include <vector>

#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr double kSide_m = 6.4;  // of the block
constexpr double kHz = 50.0, kSpeed_mps = 1.2, kRest_s = 2.0;
constexpr int kSides = 6;  // two twice

/// Moving average over a second, three times: corners become curves.
std::vector<double> smoothed(std::vector<double> values) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  for (int round = 0; round < 3; ++round) {
    std::vector<double> means;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, i - 25), end = std::min(count, i + 26);
      means.push_back(std::reduce(values.begin() + begin, values.begin() + end) / static_cast<double>(end - begin));
    }
    values = std::move(means);
  }
  return values;
}

/// Poses of a camera that is carried round the block, looking ahead, with the sway of a walk. The duration [s].
double write_walk(const std::filesystem::path& file) {
  std::vector<double> x(static_cast<std::size_t>(kRest_s * kHz), 0.0), y = x, heading = x;
  const int per_side = static_cast<int>(kSide_m / kSpeed_mps * kHz);
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  for (int side = 0; side < kSides; ++side) {
    const double yaw = side * std::numbers::pi / 2.0;
    for (int i = 0; i < per_side; ++i, at += kSide_m / per_side * Eigen::Vector2d(std::cos(yaw), std::sin(yaw)))
      x.push_back(at.x()), y.push_back(at.y()), heading.push_back(yaw);
  }
  x = smoothed(x), y = smoothed(y), heading = smoothed(heading);
  const Eigen::Quaterniond ahead(0.5, -0.5, 0.5, -0.5);  // looks along x, with y downwards
  std::ofstream out(file);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i) / kHz, begun = std::clamp(t - 0.5 * kRest_s, 0.0, 1.0);
    const double side = 0.12 * begun * std::sin(1.1 * t), up = 0.04 * begun * std::sin(7.5 * t + 1.0);
    const Eigen::Quaterniond q =
        Eigen::AngleAxisd(heading[i] + 0.2 * begun * std::sin(0.7 * t + 2.0), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(0.06 * begun * std::sin(1.9 * t), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(0.04 * begun * std::sin(2.3 * t), Eigen::Vector3d::UnitX()) * ahead;
    out << t << ' ' << x[i] - side * std::sin(heading[i]) << ' ' << y[i] + side * std::cos(heading[i]) << ' ' << up
        << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
  }
  return std::floor(static_cast<double>(x.size()) / kHz - 1.0);
}

Flight walk_round_the_block() {
  const std::filesystem::path file = testing::TempDir() + "walk_round_the_block.tum";
  SimulatorConfig config = simulator_preset("room");
  config.duration_s = write_walk(file);
  config.motion.file = file.string();
  config.scene.kind = SceneKind::Corridors;
  config.scene.objects = 30;
  config.camera.residual_px = 0.6;
  config.imu.scale_error = 0.004;
  config.imu.cross_axis_mrad = 4.0;
  config.imu.accel_walk = 1e-3;
  config.imu.gyro_walk = 1e-4;
  config.events.threshold_on = config.events.threshold_off = 9.0;  // none: they would fill the memory
  config.max_motion_px = 3.0;                                      // enough for frames
  return simulate_flight(config);
}

TEST(Loops, AreClosedByAppearanceAndCorrectTheDrift) {
  const Flight flight = walk_round_the_block();
  OdometryConfig config;
  config.map.search_px = 1.0;
  const FlightRun run = run_flight(flight.calibration, flight.measurements, Mode::Frames, config);
  config.map.enabled = false;
  const FlightRun without = run_flight(flight.calibration, flight.measurements, Mode::Frames, config);

  const double round_s = kRest_s + 4.0 * kSide_m / kSpeed_mps;
  int loops = 0;
  for (const Step& step : run.steps) {
    if (!step.loop_closure) continue;
    ++loops;
    const double t_s = to_seconds(step.t), place_s = to_seconds(step.loop_closure->keyframe);
    std::cout << "at " << t_s << " s, by the place of " << place_s << " s: " << 1e3 * step.loop_closure->position_m
              << " mm off\n";
    EXPECT_GT(t_s, round_s - 3.0);
    EXPECT_NEAR(t_s - place_s, round_s - kRest_s, 3.0) << "the same place a round earlier";
  }
  EXPECT_GE(loops, 1);
  EXPECT_EQ(run.statistics.loops_closed(), static_cast<std::size_t>(loops));
  const double final_m =
      evaluate(associate(flight.truth->trajectory, run.final_trajectory.poses), protocol("P3")).ate_m.rmse;
  const double without_m = score(flight, without).evaluation.ate_m.rmse;
  std::cout << "ATE " << 1e3 * score(flight, run).evaluation.ate_m.rmse << " mm, final " << 1e3 * final_m
            << " mm, without map " << 1e3 * without_m << " mm\n";
  EXPECT_LT(final_m, 0.8 * without_m);
}

}  // namespace
}  // namespace edged
