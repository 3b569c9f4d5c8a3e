// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What it costs to know a place again, by the number of keyframes that it may be.
#include <benchmark/benchmark.h>

#include <random>

#include "edged/map/keyframe_map.hpp"

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
    MapKeyframe keyframe{t, t, "frames", SE3(), {}};
    for (int i = 0; i < kPointsPerKeyframe; ++i) {
      MapPoint point;
      point.point = {place(random), place(random)};
      point.inverse_depth = 0.5;
      point.sigma = 0.005;
      point.descriptor = random_descriptor(random);
      keyframe.points.push_back(std::move(point));
    }
    map.add(std::move(keyframe));
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
  const MapKeyframe& there = map.keyframes()[map.keyframes().size() / 2];
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
    benchmark::DoNotOptimize(map.recognise({"frames", {}, T_M_K}, descriptors, points, R_O_C, kFocalOfTheMap));
  }
  if (!map.recognise({"frames", {}, T_M_K}, descriptors, points, R_O_C, kFocalOfTheMap))
    state.SkipWithError("not recognised");
  state.counters["descriptors"] = static_cast<double>(map.keyframes().size()) * kPointsPerKeyframe;
}
BENCHMARK(BM_RecogniseAPlace)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace edged
