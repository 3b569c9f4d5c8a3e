// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corner detection, tracking and outlier rejection of about 100 corners: items are corners.
#include <benchmark/benchmark.h>

#include "edged/frontend/test_scene.hpp"
#include "edged/frontend/trackers/klt_tracker.hpp"

namespace edged {
namespace {

constexpr int kCorners = 100;

CameraModel frame_camera_of(const benchmark::State& state) {
  return state.range(0) == 240 ? davis_like_pinhole() : CameraModel(752, 480, 458.0, 457.0, 375.5, 239.5);
}

TrackerConfig config_of_bench() {
  TrackerConfig config;
  config.detector.max_features = kCorners;
  return config;
}

const SE3 kMotion(so3::exp({0.01, -0.02, 0.02}), {0.05, 0.02, 0.03});  // about 5 px at 240 px width

void detect(benchmark::State& state, CornerKind kind) {
  const cv::Mat image = PlaneScene(frame_camera_of(state), 2.0).image(SE3());
  DetectorConfig config;
  config.corners = kind;
  std::size_t found = 0;
  for (auto _ : state) found = detect_corners(image, {}, kCorners, config).size();
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * found));
}

void BM_DetectFastHarris(benchmark::State& state) { detect(state, CornerKind::FastHarris); }
void BM_DetectShiTomasi(benchmark::State& state) { detect(state, CornerKind::ShiTomasi); }

/// One image with everything in it: pyramid, forward and backward flow, gates. Back and forth between two views.
void BM_Track(benchmark::State& state) {
  const PlaneScene scene(frame_camera_of(state), 2.0);
  const cv::Mat images[2] = {scene.image(SE3()), scene.image(kMotion)};
  const TrackPrediction there{kMotion.inverse(), 2.0, {}}, back{kMotion, 2.0, {}};
  KltTracker tracker("bench", scene.camera(), config_of_bench());
  FeatureId next_id = 1;
  tracker.track(images[0], Timestamp(), std::nullopt);
  tracker.detect(images[0], next_id);
  std::int64_t tracked = 0;
  int i = 0;
  for (auto _ : state) {
    i ^= 1;
    tracked += tracker.track(images[i], Timestamp(), i == 1 ? there : back).tracked;
  }
  state.SetItemsProcessed(tracked);
  state.counters["corners"] = static_cast<double>(tracker.tracks().size());
}

void BM_PyramidBuild(benchmark::State& state) {
  const cv::Mat image = PlaneScene(frame_camera_of(state), 2.0).image(SE3());
  ImagePyramid pyramid;
  for (auto _ : state) pyramid.build(image, KltConfig{});
}

/// 100 pairs of a room-like scene, a fifth of them wrong. range(0): 2 with the gyro's rotation, 5 without.
void BM_FindInliers(benchmark::State& state) {
  cv::RNG random(1);
  std::vector<Correspondence> pairs;
  for (int i = 0; i < kCorners; ++i) {
    const Eigen::Vector2d reference(random.uniform(-0.6, 0.6), random.uniform(-0.4, 0.4));
    const Eigen::Vector3d p = kMotion.inverse() * (random.uniform(1.0, 5.0) * reference.homogeneous());
    const Eigen::Vector2d noise(random.uniform(-0.003, 0.003), random.uniform(-0.003, 0.003));
    const Eigen::Vector2d slip = i % 5 == 0 ? Eigen::Vector2d(0.1, -0.2) : Eigen::Vector2d(0.0, 0.0);
    pairs.push_back({reference, p.hnormalized() + noise + slip});
  }
  const auto R = state.range(0) == 2 ? std::optional<Eigen::Matrix3d>(kMotion.R()) : std::nullopt;
  for (auto _ : state) benchmark::DoNotOptimize(find_inliers(pairs, R, 200.0, {}).inliers);
  state.SetItemsProcessed(state.iterations() * kCorners);
}

BENCHMARK(BM_DetectFastHarris)->ArgName("width")->Arg(240)->Arg(752);
BENCHMARK(BM_DetectShiTomasi)->ArgName("width")->Arg(240)->Arg(752);
BENCHMARK(BM_PyramidBuild)->ArgName("width")->Arg(240)->Arg(752);
BENCHMARK(BM_Track)->ArgName("width")->Arg(240)->Arg(752);
BENCHMARK(BM_FindInliers)->ArgName("points")->Arg(2)->Arg(5);

}  // namespace
}  // namespace edged
