// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Warp and accumulation of events: items are events.
#include <benchmark/benchmark.h>

#include <random>

#include "edged/events/accumulate.hpp"

namespace edged {
namespace {

const CameraModel kDavis240(240, 180, 199.37, 199.71, 133.75, 113.99, DistortionModel::RadTan,
                            {-0.382899, 0.189336, -0.0010025, -0.00056378, 0.0});
const CameraModel kVga(640, 480, 530.0, 530.0, 320.0, 240.0, DistortionModel::RadTan, {-0.3, 0.1, 0.0, 0.0, 0.0});

/// 30 ms with 0.35 events per pixel at random pixels (hard on the cache), and 1 kHz knots of a turning, moving camera.
struct Packet {
  std::vector<Event> events;
  CameraMotion motion;
};

Packet make_packet(const CameraModel& camera) {
  constexpr std::int64_t kLengthNs = 30'000'000;
  std::mt19937_64 random(1);
  const auto n = static_cast<std::size_t>(0.35 * camera.width() * camera.height());
  Packet packet;
  packet.events.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    packet.events[i] = {timestamp_from_ns(kLengthNs * static_cast<std::int64_t>(i) / static_cast<std::int64_t>(n)),
                        static_cast<std::uint16_t>(random() % static_cast<unsigned>(camera.width())),
                        static_cast<std::uint16_t>(random() % static_cast<unsigned>(camera.height())),
                        (random() & 1) != 0};
  }
  Vector6d per_s;
  per_s << 0.5, -0.2, 0.8, 1.0, -2.0, 3.0;
  for (int k = 0; k <= 30; ++k) {
    packet.motion.knots.push_back({timestamp_from_ns(k * kLengthNs / 30), SE3::exp(1e-3 * (k - 30) * per_s)});
  }
  return packet;
}

const CameraModel& camera_of(const benchmark::State& state) { return state.range(0) == 240 ? kDavis240 : kVga; }

EventFrameConfig config_of(WarpInterpolation interpolation) {
  EventFrameConfig config;
  config.interpolation = interpolation;
  return config;
}

void accumulate(benchmark::State& state, WarpInterpolation interpolation) {
  const CameraModel& camera = camera_of(state);
  const Packet packet = make_packet(camera);
  EventFrameRenderer renderer(UndistortTable(camera, ideal_pinhole(camera)), config_of(interpolation));
  for (auto _ : state) {
    cv::Mat sum = renderer.accumulate(packet.events, packet.motion, 2.0);
    benchmark::DoNotOptimize(sum.data);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * packet.events.size()));
}

void BM_AccumulatePiecewise(benchmark::State& state) { accumulate(state, WarpInterpolation::Piecewise); }
void BM_AccumulateSingleTwist(benchmark::State& state) { accumulate(state, WarpInterpolation::SingleTwist); }
void BM_AccumulateUndistortOnly(benchmark::State& state) { accumulate(state, WarpInterpolation::None); }

void BM_RenderEventFrame(benchmark::State& state) {
  const CameraModel& camera = camera_of(state);
  const Packet packet = make_packet(camera);
  EventFrameRenderer renderer(UndistortTable(camera, ideal_pinhole(camera)), config_of(WarpInterpolation::Piecewise));
  for (auto _ : state) {
    cv::Mat frame = renderer.render(packet.events, packet.motion, 2.0).image;
    benchmark::DoNotOptimize(frame.data);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * packet.events.size()));
}

BENCHMARK(BM_AccumulatePiecewise)->ArgName("width")->Arg(240)->Arg(640);
BENCHMARK(BM_AccumulateSingleTwist)->ArgName("width")->Arg(240)->Arg(640);
BENCHMARK(BM_AccumulateUndistortOnly)->ArgName("width")->Arg(240)->Arg(640);
BENCHMARK(BM_RenderEventFrame)->ArgName("width")->Arg(240)->Arg(640);

}  // namespace
}  // namespace edged
