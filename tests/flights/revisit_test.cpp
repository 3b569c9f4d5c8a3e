// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What it is worth to know where one has been: flights that come by the same places again and again.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <vector>

#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr double kDuration_s = 40.0;

FlightRun run_with(const Flight& flight, Mode mode, bool with_map) {
  OdometryConfig config;
  config.map.enabled = with_map;
  return run_flight(flight.calibration, flight.measurements, mode, config);
}

/// ATE [m] of the poses as they were known at their time, and as they were in the end.
struct Errors {
  double causal, final;
};

Errors errors(const Flight& flight, Mode mode, bool with_map) {
  const FlightRun run = run_with(flight, mode, with_map);
  EXPECT_EQ(run.statistics.last_status(), TrackingStatus::Good);
  return {score(flight, run).evaluation.ate_m.rmse,
          evaluate(associate(flight.truth->trajectory, run.final_trajectory.poses), protocol("P3")).ate_m.rmse};
}

/// Geometric means over flights: with the map over without, as known in the end over at its time, and ATE with it [mm].
struct Worth {
  double ratio, final_ratio, causal_mm;
};

Worth worth_of_the_map(std::span<const Flight> flights, Mode mode) {
  double ratio = 0.0, final_ratio = 0.0, causal = 0.0;
  for (const Flight& flight : flights) {
    const Errors without = errors(flight, mode, false), with = errors(flight, mode, true);
    std::cout << mode_name(mode) << ": " << 1e3 * without.causal << " -> " << 1e3 * with.causal << " mm, final "
              << 1e3 * with.final << " mm\n";
    EXPECT_LT(without.final, without.causal);
    ratio += std::log(with.causal / without.causal);
    final_ratio += std::log(with.final / with.causal);
    causal += std::log(1e3 * with.causal);
  }
  const auto n = static_cast<double>(flights.size());
  return {std::exp(ratio / n), std::exp(final_ratio / n), std::exp(causal / n)};
}

TEST(Revisits, HoldTheDriftOfTheOdometry) {
  // Of events a single flight's ratio scatters between 0.4 and 0.9.
  const std::array<Flight, 4> flights{simulate_flight("room", 5, kDuration_s), simulate_flight("room", 6, kDuration_s),
                                      simulate_flight("room", 7, kDuration_s), simulate_flight("room", 8, kDuration_s)};
  // Frames drift so little here that a map has nothing to hold; it must not cost either.
  const Worth frames = worth_of_the_map(flights, Mode::Frames), events = worth_of_the_map(flights, Mode::Events);
  EXPECT_LT(frames.causal_mm, 3.0);  // 2.4
  EXPECT_LT(frames.final_ratio, 1.0);
  EXPECT_LT(events.ratio, 0.8);  // 0.70
  EXPECT_LT(events.final_ratio, 1.0);
}

TEST(Revisits, HoldTheDriftOfFramesInFastMotion) {
  std::vector<Flight> flights;
  for (const int seed : {5, 7}) {
    SimulatorConfig config = simulator_preset("handheld-fast");
    config.seed = seed;
    config.duration_s = kDuration_s;
    config.events.threshold_on = config.events.threshold_off = 9.0;  // none: they would fill the memory
    config.max_motion_px = 1.5;                                      // enough for frames
    flights.push_back(simulate_flight(config));
  }
  const Worth frames = worth_of_the_map(flights, Mode::Frames);
  EXPECT_LT(frames.ratio, 0.8);
  EXPECT_LT(frames.final_ratio, 1.0);
}

TEST(Revisits, AreFoundAndKnownInTheEndToTheSameBitEachTime) {
  const Flight flight = simulate_flight("room", 5, 14.0);
  const FlightRun run = run_with(flight, Mode::Frames, true), again = run_with(flight, Mode::Frames, true);
  const FinalTrajectory &one = run.final_trajectory, &two = again.final_trajectory;
  ASSERT_GT(one.poses.size(), 100U);
  ASSERT_EQ(one.poses.size(), two.poses.size());
  for (std::size_t i = 0; i < one.poses.size(); ++i) {
    EXPECT_EQ(one.poses[i].T.translation(), two.poses[i].T.translation());
    EXPECT_EQ(one.poses[i].T.rotation().coeffs(), two.poses[i].T.rotation().coeffs());
  }
  ASSERT_FALSE(one.keyframes.empty());
  ASSERT_EQ(one.keyframes.size(), two.keyframes.size());
  EXPECT_GT(one.keyframes.front().times_found, 0);
  for (const MappedKeyframe& keyframe : one.keyframes) EXPECT_FALSE(keyframe.points.empty());
  // A step tells what it has found, and how far back that reaches.
  const auto found = std::ranges::find_if(run.steps, [](const Step& step) { return !step.map_matches.empty(); });
  ASSERT_NE(found, run.steps.end());
  EXPECT_LT(found->map_matches.front().keyframe, found->t - std::chrono::seconds(1));
}

/// For a flight whose lens is covered for 4 s while it goes on: the mean position error of the last 5 s, once the first
/// 12 s are laid onto the truth [m].
double error_after_cover(const Flight& flight, Mode mode, bool with_map) {
  const FlightRun run = run_with(flight, mode, with_map);
  EXPECT_GE(run.statistics.times_lost(), 1U);
  // A better start that takes the place of a provisional one is found again, too.
  EXPECT_EQ(std::ranges::any_of(run.steps, &Step::relocalized), with_map);
  Trajectory estimate;
  for (const Step& step : run.steps) {
    if (is_tracking(step.status)) estimate.push_back({step.t, step.state.T_W_B});
  }
  const std::vector<PosePair> pairs = associate(flight.truth->trajectory, estimate).pairs;
  const Similarity onto = align_rigidly(within(pairs, {0.0, 12.0}));
  const Timestamp late = run.steps.back().t - std::chrono::seconds(5);
  double sum = 0.0;
  int count = 0;
  for (const PosePair& pair : pairs) {
    if (pair.t < late) continue;
    sum += (onto * pair.estimate.translation() - pair.truth.translation()).norm();
    ++count;
  }
  return sum / count;
}

TEST(Revisits, FindThePlaceAgainAfterTheLensWasCovered) {
  SimulatorConfig config = simulator_preset("room");
  config.seed = 4;
  config.duration_s = 24.0;
  config.disturbance = {DisturbanceKind::LensCovered, 13.0, 4.0, 0.0};
  const Flight flight = simulate_flight(config);
  for (const Mode mode : {Mode::Frames, Mode::Fused, Mode::Events}) {
    const double without = error_after_cover(flight, mode, false), with = error_after_cover(flight, mode, true);
    std::cout << mode_name(mode) << ": " << 1e3 * without << " -> " << 1e3 * with << " mm\n";
    EXPECT_LT(without, 0.15) << "the IMU alone for 4 s";  // 0.42 to 0.76 where the body is held to stay in place
    EXPECT_LT(with, without);
    EXPECT_LT(with, mode == Mode::Events ? 0.08 : 0.03);
  }
}

constexpr double kLeave_s = 12.0, kWay_s = 5.0, kWay_m = 4.0;  // from one room into one that looks the same

/// A camera that looks square to the way between two rooms and sways alike in both (TUM, 100 Hz).
std::filesystem::path write_motion_through_twins() {
  const std::filesystem::path file = testing::TempDir() + "twins.tum";
  std::ofstream out(file);
  const Eigen::Quaterniond sideways(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()));  // along +y, upright
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.01 * i, share = std::clamp((t - kLeave_s) / kWay_s, 0.0, 1.0);
    const double way = kWay_m * share * share * share * (10.0 - 15.0 * share + 6.0 * share * share);
    const Eigen::Vector3d p(way + 0.35 * std::sin(1.3 * t), 0.2 * std::sin(1.7 * t + 1.0), 0.15 * std::sin(2.1 * t));
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.25 * std::sin(0.9 * t + 2.0), Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.12 * std::sin(1.5 * t), Eigen::Vector3d::UnitX()));
    const Eigen::Vector4d q = (turned * sideways).coeffs();
    out << fmt::format("{:.2f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", t, p.x(), p.y(), p.z(), q[0], q[1],
                       q[2], q[3]);
  }
  return file;
}

/// Points that were found and are of keyframes taken more than 2 m away, by the truth.
std::size_t wrong_relocalizations(const Flight& flight, const FlightRun& run) {
  const Trajectory& truth = flight.truth->trajectory;
  const auto true_place = [&](Timestamp t) {
    return std::ranges::lower_bound(truth, t, {}, &StampedPose::t)->T.translation();
  };
  std::size_t count = 0;
  for (const Step& step : run.steps) {
    count += std::ranges::count_if(step.map_matches, [&](const MapMatch& point) {
      return (true_place(point.keyframe) - true_place(step.t)).norm() > 2.0;
    });
  }
  return count;
}

TEST(Revisits, DoNotTakeOneOfTwoEqualRoomsForTheOther) {
  SimulatorConfig config = simulator_preset("room");
  config.duration_s = 30.0;
  config.motion.file = write_motion_through_twins();
  config.scene.twin_m = kWay_m;
  for (const bool covered : {false, true}) {
    if (covered) config.disturbance = {DisturbanceKind::LensCovered, kLeave_s, kWay_s, 0.0};
    const Flight flight = simulate_flight(config);
    for (const Mode mode : kAllModes) {
      const FlightRun run = run_with(flight, mode, true);
      const auto found = std::ranges::count_if(run.steps, [](const Step& step) { return !step.map_matches.empty(); });
      std::cout << mode_name(mode) << (covered ? ", lens covered on the way" : "") << ": found in " << found << " of "
                << run.steps.size() << " packets, ATE " << 1e3 * score(flight, run).evaluation.ate_m.rmse << " mm\n";
      EXPECT_EQ(wrong_relocalizations(flight, run), 0U);
      EXPECT_GT(found, 10);
    }
  }
}

}  // namespace
}  // namespace edged
