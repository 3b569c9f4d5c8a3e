// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/event_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr int kPixels = 4;

EventCameraConfig quiet() {
  EventCameraConfig config;
  config.threshold_sigma = config.leak_hz = config.shot_hz = 0.0;
  config.dark_radiance = 1e-6;
  return config;
}

/// The events of all pixels while the log brightness goes from 0 to log_end within a second, in 100 pictures.
std::vector<Event> ramp(const EventCameraConfig& config, double log_end, std::uint64_t seed = 1) {
  EventCamera camera(config, kPixels, kPixels, seed);
  std::vector<Event> all;
  for (int i = 0; i <= 100; ++i) {
    const std::vector<float> radiance(kPixels * kPixels, static_cast<float>(std::exp(log_end * i / 100.0)));
    const std::vector<Event> events = camera.update(timestamp_from_seconds(0.01 * i), radiance);
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

TEST(LogBrightness, IsTheNaturalLogarithm) {
  for (float x = 1e-6F; x < 100.0F; x *= 1.037F) EXPECT_NEAR(log_brightness(x), std::log(x), 2e-6) << x;
}

TEST(EventCamera, CountsAndTimesTheEventsOfARamp) {
  for (const double sign : {1.0, -1.0}) {
    const std::vector<Event> events = ramp(quiet(), sign * 3.0);
    // 3 / 0.3 events per pixel, one more or less by the initial phase.
    EXPECT_NEAR(static_cast<double>(events.size()), 10.0 * kPixels * kPixels, kPixels * kPixels);
    Timestamp last;
    for (const Event& e : events) {
      EXPECT_EQ(e.positive, sign > 0.0);
      EXPECT_EQ(to_ns(e.t) % 1000, 0);
      if (e.x != 1 || e.y != 2) continue;
      if (last != Timestamp()) {
        EXPECT_NEAR(to_seconds(e.t - last), 0.1, 2e-5);
      }
      last = e.t;
    }
    EXPECT_TRUE(std::is_sorted(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.t < b.t; }));
  }
}

TEST(EventCamera, IsSilentInStillLight) { EXPECT_TRUE(ramp(quiet(), 0.0).empty()); }

TEST(EventCamera, LeaksPositiveEventsAtItsRate) {
  EventCameraConfig config = quiet();
  config.leak_hz = 5.0;
  const std::vector<Event> events = ramp(config, 0.0);
  EXPECT_NEAR(static_cast<double>(events.size()), 5.0 * kPixels * kPixels, kPixels * kPixels);
  EXPECT_TRUE(std::all_of(events.begin(), events.end(), [](const Event& e) { return e.positive; }));
}

TEST(EventCamera, MakesShotNoiseOfBothSigns) {
  EventCameraConfig config = quiet();
  config.shot_hz = 20.0;
  const std::vector<Event> events = ramp(config, 0.0);
  EXPECT_NEAR(static_cast<double>(events.size()), 20.0 * kPixels * kPixels, 40.0);
  const auto positive = std::count_if(events.begin(), events.end(), [](const Event& e) { return e.positive; });
  EXPECT_NEAR(static_cast<double>(positive), 10.0 * kPixels * kPixels, 40.0);
}

TEST(EventCamera, SortsEventsByTimeHoweverFarThePicturesAreApart) {
  EventCameraConfig config = quiet();
  config.shot_hz = 100.0;
  EventCamera camera(config, kPixels, kPixels, 1);
  const std::vector<float> radiance(kPixels * kPixels, 1.0F);
  double t_s = 0.0;
  camera.update(timestamp_from_seconds(t_s), radiance);
  for (const double step_s : {1e-3, 5e-3, 1.0, 30.0}) {
    const std::vector<Event> events = camera.update(timestamp_from_seconds(t_s += step_s), radiance);
    EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::t)) << step_s;
    EXPECT_FALSE(events.empty()) << step_s;
  }
}

TEST(EventCamera, KeepsTheRefractoryTime) {
  EventCameraConfig config = quiet();
  config.refractory_us = 150e3;
  const std::vector<Event> events = ramp(config, 3.0);
  EXPECT_NEAR(static_cast<double>(events.size()), 5.0 * kPixels * kPixels, kPixels * kPixels);
}

TEST(EventCamera, SpreadsItsThresholds) {
  EventCameraConfig config = quiet();
  config.threshold_sigma = 0.03;
  const std::vector<Event> events = ramp(config, 30.0);
  std::vector<int> counts(kPixels * kPixels, 0);
  for (const Event& e : events) ++counts[e.y * kPixels + e.x];
  const auto [low, high] = std::minmax_element(counts.begin(), counts.end());
  EXPECT_GT(*high - *low, 10);
  EXPECT_GT(*low, 65);
  EXPECT_LT(*high, 160);
}

TEST(EventCamera, FollowsSlowlyWithALowBandwidth) {
  EventCameraConfig config = quiet();
  config.bandwidth_hz = 2.0;
  EXPECT_LT(ramp(config, 3.0).size(), ramp(quiet(), 3.0).size());
}

TEST(EventCamera, FollowsFasterInMoreLight) {
  EventCameraConfig config = quiet();
  config.bandwidth_per_radiance_hz = 2.0;
  const auto events_after_step = [&](float from) {
    EventCamera camera(config, kPixels, kPixels, 1);
    std::size_t count = 0;
    for (int i = 0; i <= 20; ++i) {
      const std::vector<float> radiance(kPixels * kPixels, i == 0 ? from : 4.0F * from);
      count += camera.update(timestamp_from_seconds(0.005 * i), radiance).size();
    }
    return count;
  };
  EXPECT_GT(events_after_step(1.0F), 3 * kPixels * kPixels);
  EXPECT_LT(events_after_step(0.01F), kPixels * kPixels);
}

TEST(EventCamera, HasHotPixelsThatFireAtTheirRate) {
  EventCameraConfig config = quiet();
  config.hot_pixels = 1;
  config.hot_hz = 100.0;
  const std::vector<Event> events = ramp(config, 0.0);
  EXPECT_GE(events.size(), 10U);
  EXPECT_LE(events.size(), 110U);
  EXPECT_TRUE(std::all_of(events.begin(), events.end(),
                          [&](const Event& e) { return e.x == events.front().x && e.y == events.front().y; }));
}

}  // namespace
}  // namespace edged
