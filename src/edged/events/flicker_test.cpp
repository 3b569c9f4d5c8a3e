// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/flicker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include "edged/events/test_support.hpp"

namespace edged {
namespace {

constexpr int kSide = 32;
constexpr double kThreshold = 0.3;

constexpr double kBand_px = 16.0;

/// Pixels that see a bright band go round the array, in light of this frequency and modulation.
struct FlickerScene {
  double hz = 0.0, modulation = 0.0;
  double band_px_s = 0.0;  ///< 0: there is no band
  double off_share = 1.0;  ///< the thresholds of fall over those of rise

  /// How far the band's first edge is beyond the pixel, 0 to kSide [px].
  double passed(int x, double t) const { return std::fmod(band_px_s * t - x + 1e3 * kSide, kSide); }
  double light(int x, double t) const {
    constexpr double kContrast = 1.5;  // of logarithms
    const double place = passed(x, t);
    const double band = std::clamp(place, 0.0, 1.0) - std::clamp(place - kBand_px, 0.0, 1.0);
    return (band_px_s > 0.0 ? kContrast * band : 0.0) +
           std::log1p(modulation * std::sin(2.0 * std::numbers::pi * hz * t));
  }
};

std::vector<Event> events_of(const FlickerScene& scene, double seconds) {
  std::mt19937_64 random(1);
  std::vector<double> reference(kSide * kSide);
  for (double& level : reference) level = uniform(random, -kThreshold, kThreshold);
  std::vector<Event> events;
  std::array<double, kSide> light{};
  for (double t = 0.0; t < seconds; t += 1e-4) {
    for (int x = 0; x < kSide; ++x) light[static_cast<std::size_t>(x)] = scene.light(x, t);
    for (std::size_t i = 0; i < reference.size(); ++i) {
      const auto x = static_cast<std::uint16_t>(i % kSide), y = static_cast<std::uint16_t>(i / kSide);
      const double rise = kThreshold, fall = kThreshold * scene.off_share;
      for (; light[x] - reference[i] >= rise; reference[i] += rise)
        events.push_back({timestamp_from_seconds(t), x, y, true});
      for (; reference[i] - light[x] >= fall; reference[i] -= fall)
        events.push_back({timestamp_from_seconds(t), x, y, false});
    }
  }
  return events;
}

std::optional<double> detected_hz(const std::vector<Event>& events) {
  FlickerDetector detector;
  for (const Event& event : events) detector.add(event.t, event.positive);
  return detector.lamp() ? std::optional(detector.lamp()->hz) : std::nullopt;
}

/// Share of the events after 0.6 s, when the frequency is known, that stay.
double share_kept(const std::vector<Event>& events) {
  FlickerFilter filter(kSide, kSide);
  double kept = 0.0, all = 0.0;
  for (const Event& event : events) {
    const bool dropped = filter.drops(event);
    if (to_seconds(event.t) < 0.6) continue;
    ++all, kept += dropped ? 0.0 : 1.0;
  }
  return kept / all;
}

TEST(FlickerDetector, FindsTheFrequencyOfTheLight) {
  for (const double hz : {100.0, 120.0, 123.4, 240.0, 500.0}) {
    const auto found = detected_hz(events_of({.hz = hz, .modulation = 0.5}, 0.9));
    ASSERT_TRUE(found) << hz;
    EXPECT_NEAR(*found, hz, 1.0);
  }
}

TEST(FlickerDetector, FindsItUnderMotion) {
  const auto found = detected_hz(events_of({.hz = 100.0, .modulation = 0.4, .band_px_s = 500.0}, 0.9));
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 100.0, 1.0);
}

TEST(FlickerDetector, GivesThePhaseOfTheLight) {
  for (const double hz : {100.0, 121.3}) {
    FlickerDetector detector;
    for (const Event& event : events_of({.hz = hz, .modulation = 0.5}, 0.9)) detector.add(event.t, event.positive);
    ASSERT_TRUE(detector.lamp());
    // The light rises fastest at whole cycles; a pixel's events lag behind it by a part of its threshold.
    const double phase = detector.lamp()->phase(timestamp_from_seconds(100.0 / hz));
    EXPECT_NEAR(std::cos(phase), 1.0, 0.15) << phase;
  }
}

TEST(FlickerDetector, CountsManyEventsAtOnceAsOneByOne) {
  constexpr std::size_t kMany = 97;
  const std::vector<Event> events = events_of({.hz = 121.3, .modulation = 0.5}, 0.9);
  FlickerDetector one_by_one, at_once;
  std::size_t taken = 0;
  for (std::size_t i = 0; i + kMany <= events.size(); i += kMany) {
    const std::span many = std::span(events).subspan(i, kMany);
    for (const Event& event : many) one_by_one.add(event.t, event.positive);
    if (at_once.add(many)) {
      ++taken;
    } else {
      for (const Event& event : many) at_once.add(event.t, event.positive);
    }
  }
  EXPECT_GT(taken, events.size() / kMany * 9 / 10) << "all but those in which a window ends";
  ASSERT_TRUE(one_by_one.lamp() && at_once.lamp());
  EXPECT_EQ(at_once.lamp()->hz, one_by_one.lamp()->hz);
  EXPECT_EQ(at_once.lamp()->crest, one_by_one.lamp()->crest);
}

TEST(FlickerDetector, TakesNoMotionForALamp) {
  EXPECT_FALSE(detected_hz(events_of({.band_px_s = 40.0}, 2.0)));
  // The band comes by 100 times a second.
  EXPECT_FALSE(detected_hz(events_of({.band_px_s = 3200.0}, 1.0)));
}

TEST(FlickerDetector, TakesNoStepsOfStampsForALamp) {
  // Of events of which four of five are positive, stamped in milliseconds and in bursts of 10 ms.
  std::mt19937_64 random(2);
  for (const double step_s : {1e-3, 1e-2}) {
    std::vector<Event> events;
    for (int i = 0; i < 100'000; ++i) {
      const double t = std::floor(1e-5 * i / step_s) * step_s;
      events.push_back({timestamp_from_seconds(t), 3, 4, uniform(random, 0.0, 1.0) < 0.8});
    }
    EXPECT_FALSE(detected_hz(events)) << step_s;
  }
}

TEST(FlickerDetector, EndsWithTheFlicker) {
  std::vector<Event> events = events_of({.hz = 100.0, .modulation = 0.5}, 0.9);
  for (const Event& event : events_of({.band_px_s = 300.0}, 1.0))
    events.push_back({event.t + std::chrono::milliseconds(900), event.x, event.y, event.positive});
  EXPECT_FALSE(detected_hz(events));
}

TEST(FlickerFilter, DropsTheEventsOfALamp) {
  EXPECT_LT(share_kept(events_of({.hz = 100.0, .modulation = 0.5}, 1.2)), 0.01);
  EXPECT_LT(share_kept(events_of({.hz = 120.0, .modulation = 0.9}, 1.2)), 0.01);
  // More falls than rises.
  EXPECT_LT(share_kept(events_of({.hz = 100.0, .modulation = 0.8, .off_share = 0.8}, 1.2)), 0.05);
}

TEST(FlickerFilter, KeepsEventsOfEdgesUnderALamp) {
  const FlickerScene scene{.hz = 100.0, .modulation = 0.5, .band_px_s = 100.0};
  FlickerFilter filter(kSide, kSide);
  double kept = 0.0, of_edges = 0.0;
  for (const Event& event : events_of(scene, 1.2)) {
    const double t = to_seconds(event.t);
    if (filter.drops(event) || t < 0.6) continue;
    const double behind_first = scene.passed(event.x, t), behind_last = std::abs(behind_first - kBand_px);
    ++kept, of_edges += std::min({behind_first, kSide - behind_first, behind_last}) < 2.0 ? 1.0 : 0.0;
  }
  // Each edge crosses each row at 100 px/s.
  EXPECT_GT(of_edges, 0.7 * 2.0 * 0.6 * 100.0 * kSide);
  EXPECT_GT(of_edges, 0.8 * kept);
}

TEST(FlickerFilter, DropsNothingWithoutALamp) { EXPECT_EQ(share_kept(events_of({.band_px_s = 200.0}, 1.5)), 1.0); }

}  // namespace
}  // namespace edged
