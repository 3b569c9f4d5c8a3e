// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/flicker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"
#include "edged/sim/simulator.hpp"
#include "edged/sim/test_recording.hpp"

namespace edged {
namespace {

Disturbance flickering(double modulation) { return {DisturbanceKind::Flicker, 0.0, 10.0, modulation}; }

/// Mean, least and most of the deviation over a second, linear between the knots.
struct Wave {
  double mean = 0.0, least = 0.0, most = 0.0;
};

Wave measure(const Flicker& flicker) {
  Wave wave;
  double t = 1.0, before = flicker.at(t, SE3()).deviation;
  while (t < 2.0 - 1e-9) {
    const double next = flicker.next_knot_s(t), now = flicker.at(next, SE3()).deviation;
    EXPECT_GT(next, t);
    wave.mean += 0.5 * (before + now) * (next - t);
    wave.least = std::min(wave.least, now), wave.most = std::max(wave.most, now);
    t = next, before = now;
  }
  return wave;
}

TEST(Flicker, KeepsTheMeanLightAndHasTheModulation) {
  for (const FlickerWave kind : {FlickerWave::Mains, FlickerWave::Pwm}) {
    for (const double modulation : {0.05, 0.25, 1.0}) {
      const Wave wave = measure({{kind, 100.0, 0.3}, flickering(modulation), Eigen::Vector3d::Zero()});
      EXPECT_NEAR(wave.mean, 0.0, 1e-4);
      EXPECT_NEAR((wave.most - wave.least) / (2.0 + wave.most + wave.least), modulation, 1e-3);
    }
  }
}

TEST(Flicker, OfOneLampDecreasesWithTheDistance) {
  const Flicker flicker({FlickerWave::Pwm, 100.0, 0.5, 0.8}, flickering(0.5), {1.0, 0.0, 0.0});
  const FlickerNow now = flicker.at(1.002, SE3());
  EXPECT_NEAR(now.deviation, 0.5, 1e-6);
  EXPECT_NEAR(now.factor({1.0F, 0.0F, 0.0F}), 1.5, 1e-6);
  EXPECT_NEAR(now.factor({1.0F, 0.8F, 0.0F}), 1.25, 1e-6);
  EXPECT_NEAR(now.factor({1.0F, 0.0F, 8.0F}), 1.005, 1e-3);
}

SimulatorConfig resting(const char* hz, double modulation) {
  SimulatorConfig config;
  config.duration_s = 1.2, config.motion.rest_s = 1.2;
  config.camera.width = 64, config.camera.height = 48;
  config.events.leak_hz = config.events.shot_hz = 0.0;
  config.frames.exposure_ms = 4.0;
  config.disturbance = {DisturbanceKind::Flicker, 0.2, 0.0, modulation};
  ConfigFields::of(config).set(std::string("flicker.hz=") + hz);
  return config;
}

TEST(Flicker, GivesEventsInBothDirectionsInEachCycle) {
  const Recorded recorded = record(resting("120", 0.5));
  std::array<int, 8> sum{};
  double total = 0.0;
  for (const Event& event : recorded.events) {
    const double t = to_seconds(event.t);
    if (t < 0.3) continue;
    ++total;
    sum[static_cast<std::size_t>(8.0 * (t * 120.0 - std::floor(t * 120.0)))] += event.positive ? 1 : -1;
  }
  // The light swings by a logarithm of 1.10 up and down; thresholds are 0.3, and one is lost at each turn.
  EXPECT_NEAR(total / (0.9 * 120 * 64 * 48), 2.0 * (1.10 / 0.3 - 1.0), 1.0);
  EXPECT_GT(sum[0], 0.05 * total);
  EXPECT_LT(sum[3], -0.05 * total);
  EXPECT_LT(std::abs(std::accumulate(sum.begin(), sum.end(), 0)), 0.02 * total);
}

TEST(Flicker, ChangesTheBrightnessOfFramesByWhatTheirExposureDoesNotAverage) {
  // 24 Hz frames beat with 100 Hz; 4 ms are 0.4 of its cycle, over which a sine of 0.25 averages to 0.19.
  double least = 1e9, most = 0.0;
  const Recorded recorded = record(resting("100", 0.25));
  for (const Frame& frame : recorded.frames) {
    if (to_seconds(frame.t) < 0.25) continue;
    const double level = cv::mean(frame.image)[0];
    least = std::min(least, level), most = std::max(most, level);
  }
  EXPECT_NEAR((most - least) / (most + least), 0.19, 0.04);
}

TEST(Flicker, AModulationBeyondOneIsRefused) {
  SimulatorConfig config;
  config.disturbance = {DisturbanceKind::Flicker, 1.0, 1.0, 1.1};
  EXPECT_THROW(Simulator{config}, InputError);
}

}  // namespace
}  // namespace edged
