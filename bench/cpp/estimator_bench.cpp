// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One optimisation of a full window, one marginalisation, and the estimator packet by packet.
#include "edged/estimator/estimator.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>

#include "edged/estimator/solver/marginalization.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/cost.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {
namespace {

constexpr int kKeyframes = 8, kRecent = 3, kLandmarksPerCamera = 60;
constexpr double kKeyframeStep_s = 0.1, kRecentStep_s = 0.03;

/// Keyframes and recent states near the truth, two cameras with 60 landmarks each, a gauge and bias prior.
Window full_window(TestWorld& world) {
  Window window(world.rig());
  OdomState nav;
  double t = 1.0;
  world.packet(t - kKeyframeStep_s, kKeyframeStep_s, true);
  for (int i = 0; i < kKeyframes + kRecent; ++i) {
    const double step = i < kKeyframes ? kKeyframeStep_s : kRecentStep_s;
    if (i > 0) t += step;
    const EstimatorInput input = world.packet(t, step, true);
    WindowState state;
    state.t = input.t;
    state.pose = to_block(world.T_W_B(t) * SE3(so3::exp({0.002, -0.001, 0.003}), {0.005, -0.003, 0.002}));
    Eigen::Map<Eigen::Vector3d>(state.motion.data()) = world.v_W(t);
    state.keyframe = i < kKeyframes;
    if (i > 0) state.imu = input.motion;
    window.add_state(std::move(state), input.observations);
  }
  const auto& [first, state] = *window.states().begin();
  window.add_soft_prior(gauge_prior({BlockKind::Pose, first}, state.pose, 1e-4, 1e-4));
  window.add_soft_prior(motion_prior({BlockKind::Motion, first}, state.motion, {0.1, 0.02, 0.15}));
  LandmarkConfig config;
  config.max_per_camera = kLandmarksPerCamera;
  triangulate_features(window, config);
  return window;
}

std::size_t count_observations(const Window& window) {
  std::size_t observations = 0;
  for (const auto& [id, feature] : window.features())
    observations += feature.anchor ? feature.observations.size() - 1 : 0;
  return observations;
}

/// range(0): solver iterations. Items are observations.
void BM_SolveWindow(benchmark::State& state) {
  TestWorld world({.cameras = 2});
  Window window = full_window(world);
  const std::vector<double> start = window.estimates();
  const std::size_t observations = count_observations(window);
  int iterations = 0;
  for (auto _ : state) {
    window.restore(start);
    iterations = solve(window, static_cast<int>(state.range(0))).iterations;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * observations));
  state.counters["observations"] = static_cast<double>(observations);
  state.counters["iterations"] = iterations;
}

/// The oldest keyframe and its landmarks leave.
void BM_Marginalize(benchmark::State& state) {
  TestWorld world({.cameras = 2});
  Window window = full_window(world);
  solve(window, 10);
  const StateId oldest = window.oldest_id();
  const std::set<BlockKey> leaving = {{BlockKind::Pose, oldest}, {BlockKind::Motion, oldest}};
  Cost cost = cost_of(window);
  std::erase_if(cost.factors, [&](const auto& factor) { return !factor->marginalized_with(leaving); });
  std::erase_if(cost.landmarks, [&](const LandmarkTerm& term) { return term.anchor.state != oldest; });
  for (auto _ : state) benchmark::DoNotOptimize(marginalize(window, cost, leaving).J);
  state.counters["factors"] = static_cast<double>(cost.factors.size());
  state.counters["landmarks"] = static_cast<double>(cost.landmarks.size());
}

/// A running estimator; items are packets of 30 ms, every sixth a keyframe. range(0): cameras.
void BM_EstimatorAdd(benchmark::State& state) {
  constexpr double kStart_s = 1.5;
  TestWorld world({.rest_s = 1.0, .cameras = static_cast<int>(state.range(0))});
  std::vector<EstimatorInput> packets;
  for (int i = 1; i <= 300; ++i) packets.push_back(world.packet(i * kRecentStep_s, kRecentStep_s, i % 6 == 0));
  std::optional<Estimator> estimator;
  std::size_t next = packets.size();
  double observations = 0.0;
  for (auto _ : state) {
    if (next == packets.size()) {
      state.PauseTiming();
      estimator.emplace(world.rig(), world.noise(), EstimatorConfig());
      for (next = 0; to_seconds(packets[next].t) < kStart_s; ++next) estimator->add(packets[next]);
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(estimator->add(packets[next++]).landmarks);
    observations += static_cast<double>(count_observations(estimator->window()));
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["observations"] = observations / static_cast<double>(state.iterations());
}

BENCHMARK(BM_SolveWindow)->ArgName("iterations")->Arg(1)->Arg(4)->Arg(10)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Marginalize)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_EstimatorAdd)->ArgName("cameras")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace edged
