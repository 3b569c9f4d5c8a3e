// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What it costs to know a place again and to take up what was found of it, by the number of keyframes, and to know the
// whole path in the end, by its length.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "edged/map/keyframe_map.hpp"
#include "edged/map/map_filter.hpp"
#include "edged/map/odom_to_map.hpp"
#include "edged/map/trajectory/trajectory_smoother.hpp"
#include "memory_use.hpp"

namespace edged {
namespace {

constexpr int kPointsPerKeyframe = 60, kCornersOfAnImage = 120;
constexpr double kFocalOfTheMap = 200.0;
constexpr int kFlippedBits = 20;  // of a descriptor from one image to another

Descriptor random_descriptor(std::mt19937_64& random) { return {random(), random(), random(), random()}; }

/// Keyframes around the origin, points on a wall before each, all of them looking different.
KeyframeMap map_of(int keyframes, std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  KeyframeMap map({});
  for (int k = 0; k < keyframes; ++k) {
    const Timestamp t = timestamp_from_seconds(k);
    MapView view{"frames", SE3(), {}};
    for (int i = 0; i < kPointsPerKeyframe; ++i) {
      MapPoint point;
      point.point = {place(random), place(random)};
      point.inverse_depth = 0.5;
      point.sigma = 0.005;
      point.descriptor = random_descriptor(random);
      view.points.push_back(std::move(point));
    }
    map.add({t, t, {std::move(view)}});
  }
  return map;
}

/// range(0): keyframes. Half of the corners are points of one of them, seen from where it was; the others are of
/// nowhere.
void BM_RecogniseAPlace(benchmark::State& state) {
  std::mt19937_64 random(1);
  const KeyframeMap map = map_of(static_cast<int>(state.range(0)), random);
  // Cameras that look along the horizon.
  const Eigen::Quaterniond R_O_C(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()));
  const std::vector<SE3> T_M_K(map.keyframes().size(), SE3(R_O_C, Eigen::Vector3d::Zero()));
  const MapView& there = map.keyframes()[map.keyframes().size() / 2].views.front();
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::vector<std::optional<Descriptor>> descriptors;
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < kCornersOfAnImage; ++i) {
    const bool known = i < kPointsPerKeyframe;
    Descriptor descriptor = known ? *there.points[static_cast<std::size_t>(i)].descriptor : random_descriptor(random);
    for (int bit = 0; bit < kFlippedBits; ++bit) descriptor[random() % 4] ^= std::uint64_t{1} << (random() % 64);
    descriptors.emplace_back(descriptor);
    points.push_back(known ? there.points[static_cast<std::size_t>(i)].point
                           : Eigen::Vector2d(place(random), place(random)));
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(map.recognize({"frames", {}, T_M_K}, descriptors, points, R_O_C, kFocalOfTheMap));
  }
  if (!map.recognize({"frames", {}, T_M_K}, descriptors, points, R_O_C, kFocalOfTheMap).T_M_C)
    state.SkipWithError("not recognized");
  state.counters["descriptors"] = static_cast<double>(map.keyframes().size()) * kPointsPerKeyframe;
}
BENCHMARK(BM_RecogniseAPlace)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

constexpr int kKeyframesInView = 8, kSightsOfOne = 8;

Eigen::Vector3d point_ahead(int i) { return {i % 3 - 1.0, i % 4 - 1.5, 3.0 + 0.3 * i}; }

/// range(0): keyframes along a street, 0.4 m apart, that looks ahead. Some of the points of thirty of them are in view.
void BM_SelectCandidates(benchmark::State& state) {
  std::mt19937_64 random(1);
  const double before_mb = resident_mb();
  KeyframeMap map = map_of(static_cast<int>(state.range(0)), random);
  state.counters["kB_per_keyframe"] =
      1024.0 * (resident_mb() - before_mb) / static_cast<double>(map.keyframes().size());
  std::vector<SE3> T_M_K;
  for (std::size_t k = 0; k < map.keyframes().size(); ++k)
    T_M_K.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 0.4 * static_cast<double>(k)));
  const SE3 T_M_C(Eigen::Quaterniond::Identity(), T_M_K[T_M_K.size() / 2].translation());
  const CameraModel camera(240, 180, kFocalOfTheMap, kFocalOfTheMap, 119.5, 89.5);
  for (auto _ : state) benchmark::DoNotOptimize(map.visible({"frames", {}, T_M_K}, T_M_C, camera, 80));
}
BENCHMARK(BM_SelectCandidates)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

/// range(0): keyframes, of which eight are seen; range(1): those with a joint covariance.
void BM_TakeUpWhatWasFound(benchmark::State& state) {
  const double before_mb = resident_mb();
  MapFilter filter(MapFilterConfig{}, false, static_cast<int>(state.range(1)));
  filter.restart(SE3(), SE3(), Timestamp{}, 0.0, 0.0);
  for (int k = 0; k < state.range(0); ++k) {
    const Timestamp t = timestamp_from_seconds(0.3 * k);
    filter.predict(SE3(), SE3(), t, kMapTuning.final_drift);
    filter.add_keyframe(SE3(), SE3(), t);
  }
  std::vector<MapObservation> observations;
  for (std::uint32_t keyframe = 0; keyframe < kKeyframesInView; ++keyframe) {
    for (int i = 0; i < kSightsOfOne; ++i) {
      const Eigen::Vector3d p = point_ahead(i);
      observations.push_back({keyframe, p, 0.01 * p, p.hnormalized(), 0.01});
    }
  }
  filter.activate(std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  state.counters["MB"] = resident_mb() - before_mb;
  for (auto _ : state) benchmark::DoNotOptimize(filter.update(observations, observations.size(), {SE3()}));
}
BENCHMARK(BM_TakeUpWhatWasFound)
    ->Args({25, 100})
    ->Args({100, 100})
    ->Args({400, 400})
    ->Args({1000, 1000})
    ->Args({1000, 100})
    ->Args({10000, 100})
    ->Unit(benchmark::kMillisecond);

/// range(0): keyframes of a street. The body comes back to its beginning, by the other side: eight of them become
/// active, and parents of what is between; then it goes on at its end, and they are deactivated again.
void BM_ComeBack(benchmark::State& state) {
  MapFilter filter{MapFilterConfig{}};
  filter.restart(SE3(), SE3(), Timestamp{}, 0.0, 0.0);
  std::vector<std::uint32_t> begin, end;
  for (std::uint32_t k = 0; k < state.range(0); ++k) {
    const Timestamp t = timestamp_from_seconds(0.3 * k);
    filter.predict(SE3(), SE3(), t, kMapTuning.final_drift);
    filter.add_keyframe(SE3(), SE3(), t);
    (k < kKeyframesInView ? begin : end).push_back(k);
  }
  end.erase(end.begin(), end.end() - 100);
  double t = 0.3 * static_cast<double>(state.range(0));
  for (auto _ : state) {
    filter.activate(begin);
    filter.predict(SE3(), SE3(), timestamp_from_seconds(t += 0.3), kMapTuning.final_drift);
    filter.activate(end);
    filter.predict(SE3(), SE3(), timestamp_from_seconds(t += 0.3), kMapTuning.final_drift);
  }
}
BENCHMARK(BM_ComeBack)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

constexpr double kLook_s = 0.25, kPose_s = 0.05;
constexpr int kLooksPerKeyframe = 12;

/// A camera that sways before a wall for so long, an odometry whose drift the map has held, and what was found.
TrajectorySmoother record_of(double duration_s, std::size_t most_keyframes) {
  const auto true_pose = [](double t) {
    return SE3(so3::exp({0.1 * std::sin(0.7 * t), 0.2 * std::sin(t), 0.0}),
               {std::sin(0.3 * t), std::sin(0.4 * t), 0.0});
  };
  TrajectorySmoother record;
  std::vector<double> made_at;
  record.restart({Timestamp{}, true_pose(0.0)}, 0.01, 0.01);
  for (int i = 1; kPose_s * i < duration_s; ++i) {
    const double t = kPose_s * i;
    const StampedPose T_O_B{timestamp_from_seconds(t), true_pose(t)};
    record.add(T_O_B);
    const int looks = static_cast<int>(std::lround(kLook_s / kPose_s));
    if (i % looks != 0) continue;
    if (i % (looks * kLooksPerKeyframe) == 0 && made_at.size() < most_keyframes) {
      record.add_keyframe(T_O_B);
      made_at.push_back(t);
    }
    if (made_at.size() < kKeyframesInView) continue;
    std::vector<MapObservation> observations;
    for (std::size_t n = 0; n < kKeyframesInView; ++n) {
      const auto keyframe = static_cast<std::uint32_t>((static_cast<std::size_t>(i / looks) + n) % made_at.size());
      for (int k = 0; k < kSightsOfOne; ++k) {
        const Eigen::Vector3d p_K = true_pose(made_at[keyframe]).inverse() * point_ahead(k);
        observations.push_back(
            {keyframe, p_K, 0.01 * p_K, (true_pose(t).inverse() * point_ahead(k)).hnormalized(), 0.01});
      }
    }
    record.add_observations(T_O_B, {SE3()}, observations);
  }
  return record;
}

/// range(0): minutes; range(1): keyframes of the map, at most.
void BM_KnowThePathInTheEnd(benchmark::State& state) {
  const double before_mb = resident_mb();
  const TrajectorySmoother record =
      record_of(60.0 * static_cast<double>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  state.counters["record_MB"] = resident_mb() - before_mb;
  forget_most_resident();
  OdomToMap odom_to_map;  // O is M
  odom_to_map.restart(Timestamp{});
  for (auto _ : state) benchmark::DoNotOptimize(record.path(odom_to_map, record.solve(odom_to_map)));
  state.counters["most_MB"] = most_resident_mb() - before_mb;
}
BENCHMARK(BM_KnowThePathInTheEnd)
    ->Args({6, 100})
    ->Args({20, 100})
    ->Args({60, 100})
    ->Args({60, 1000})
    ->Unit(benchmark::kSecond)
    ->Iterations(1);

}  // namespace
}  // namespace edged
