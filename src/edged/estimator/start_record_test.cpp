// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A flight of the estimator, and the window of all that has left its window.
#include "edged/estimator/window/start_record.hpp"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "edged/estimator/solver/banded_layout.hpp"
#include "edged/estimator/solver/normal_equations.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/test_tracks.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

constexpr int kIterations = 15;

struct Flight {
  explicit Flight(const TestWorldOptions& options = {.rest_s = 1.0}, double duration_s = 12.0,
                  const EstimatorConfig& config = {}, bool heights = false)
      : world(options) {
    Estimator estimator(world.rig(), world.noise(), config);
    TracksOnce tracks;
    for (int i = 1; i * kPacket_s <= duration_s; ++i) {
      const double t = i * kPacket_s;
      EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
      tracks.rename(input);
      if (heights) input.external.emplace_back(world.height(t - 0.01, 0.02));
      for (MarginalizedKeyframe& keyframe : estimator.add(input).marginalized_keyframes)
        marginalized.push_back({keyframe.t, keyframe.T_O_B});
    }
    record = estimator.record();
  }

  /// RMS error of the motion over five keyframes.
  double error(const Trajectory& poses) const {
    constexpr std::size_t kApart = 5;
    double sum = 0.0;
    for (std::size_t i = kApart; i < poses.size(); ++i) {
      const auto& [t_0, T_0] = poses[i - kApart];
      const auto& [t_1, T_1] = poses[i];
      const SE3 truth = world.T_W_B(seconds(t_0)).inverse() * world.T_W_B(seconds(t_1));
      sum += ((T_0.inverse() * T_1).translation() - truth.translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(poses.size() - kApart));
  }
  static double seconds(Timestamp t) { return to_seconds(t - Timestamp{}); }

  TestWorld world;
  Trajectory marginalized;
  StartRecord record;
};

Trajectory poses_of(const Window& window, std::size_t count) {
  Trajectory poses;
  for (const auto& [id, state] : window.states())
    if (poses.size() < count) poses.push_back({state.t, state.T_O_B()});
  return poses;
}

std::size_t stored_entries(const Window& window) {
  const Cost cost = cost_of(window);
  std::size_t entries = 0;
  const EnvelopeMatrix H(banded_layout(window, cost).envelope);
  for (EnvelopeMatrix::Index i = 0; i < H.size(); ++i) entries += static_cast<std::size_t>(i - H.first(i));
  return entries;
}

TEST(StartRecord, IsEmptyBeforeTheStart) {
  TestWorld world({.rest_s = 1.0});
  EXPECT_TRUE(Estimator(world.rig(), world.noise(), {}).record().empty());
}

TEST(StartRecord, HoldsEachStateObservationAndFactorOnce) {
  const StartRecord& record = Flight().record;
  std::set<StateId> states;
  for (const StartRecord::State& state : record.states) EXPECT_TRUE(states.insert(state.id).second);
  std::set<std::tuple<FeatureId, std::uint32_t, std::uint32_t>> observations;
  for (std::size_t i = 0; i < record.parts.size(); ++i) {
    const std::size_t end = i + 1 < record.parts.size() ? record.parts[i + 1].first : record.observations.size();
    for (std::size_t k = record.parts[i].first; k < end; ++k) {
      const StartRecord::Observation& seen = record.observations[k];
      EXPECT_TRUE(observations.emplace(record.parts[i].id, seen.state, seen.camera).second);
      EXPECT_TRUE(states.contains(seen.state));
    }
  }
  std::set<const Factor*> factors;
  for (const auto& factor : record.factors) EXPECT_TRUE(factors.insert(factor.get()).second);
  EXPECT_GT(states.size(), 40U);
  EXPECT_GT(observations.size(), 30 * states.size());
}

/// The window learns the calibration on the way: the whole start is solved with what it knows in the end.
TEST(StartRecord, SolvedAsAWholeIsMoreAccurateThanTheWindowWas) {
  double whole = 0.0, marginalized = 0.0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Flight flight(
        {.rest_s = 1.0, .pixel_noise = 0.1, .pixel_walk = 0.4, .rotation_error = {0.012, -0.01, 0.008}, .seed = seed},
        16.0);
    Window window(flight.record);
    const SolveSummary summary = solve_long(window, kIterations);
    ASSERT_TRUE(summary.usable);
    EXPECT_LT(summary.final_cost, summary.initial_cost);
    whole += flight.error(poses_of(window, flight.marginalized.size()));
    marginalized += flight.error(flight.marginalized);
  }
  EXPECT_LT(whole, 0.9 * marginalized);
}

TEST(StartRecord, HasOneSolutionToTheLastBit) {
  const Flight flight;
  Window one(flight.record), two(flight.record);
  solve_long(one, kIterations);
  solve_long(two, kIterations);
  EXPECT_EQ(one.estimates(), two.estimates());
}

TEST(StartRecord, HasTheSolutionOfDenseEquations) {
  const Flight flight({.rest_s = 1.0, .cameras = 2}, 5.0);
  Window banded(flight.record), dense(flight.record);
  const SolveSummary summary = solve_long(banded, kIterations);
  EXPECT_NEAR(summary.final_cost, solve(dense, kIterations).final_cost, 1e-4 * summary.final_cost);
}

TEST(StartRecord, KeepsTheChainOfTheLevelOfAHeightSensor) {
  const Flight flight({.rest_s = 1.0}, 12.0, {}, true);
  std::set<std::uint64_t> levels;
  for (const StartRecord::Parameter& parameter : flight.record.parameters)
    EXPECT_TRUE(levels.insert(parameter.key.id).second);
  EXPECT_GT(levels.size(), 30U);
  Window window(flight.record);
  const SolveSummary summary = solve_long(window, kIterations);
  EXPECT_TRUE(summary.usable);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  EXPECT_LT(flight.error(poses_of(window, flight.marginalized.size())), 0.05);
}

TEST(StartRecord, TakesMemoryThatGrowsWithItsStates) {
  const Flight shorter({.rest_s = 1.0}, 30.0), longer({.rest_s = 1.0}, 60.0);
  const Window window(shorter.record), twice(longer.record);
  ASSERT_GT(twice.states().size(), 250U);
  const double states = static_cast<double>(twice.states().size()) / static_cast<double>(window.states().size());
  EXPECT_LT(static_cast<double>(stored_entries(twice)), 1.1 * states * static_cast<double>(stored_entries(window)));
}

TEST(StartRecord, StaysWhereItIsWithoutAnyObservation) {
  TestWorld world({.rest_s = 20.0});
  Estimator estimator(world.rig(), world.noise(), {});
  for (int i = 1; i * kPacket_s <= 20.0; ++i) {
    EstimatorInput input = world.packet(i * kPacket_s, kPacket_s, i % 4 == 0);
    if (i * kPacket_s > 2.0)
      for (CameraObservations& view : input.observations) view.features.clear();
    estimator.add(input);
  }
  Window window(estimator.record());
  EXPECT_TRUE(solve_long(window, kIterations).usable);
  for (const auto& [id, state] : window.states()) EXPECT_LT(state.T_O_B().translation().norm(), 0.05);
}

}  // namespace
}  // namespace edged
