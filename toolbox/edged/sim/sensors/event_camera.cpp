// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/event_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "edged/core/check.hpp"

namespace edged {

void EventCameraConfig::visit(ConfigFields& fields) {
  fields.add("threshold_on", threshold_on, {"ln", 0.01, 10, "rise of the log brightness that makes a positive event"});
  fields.add("threshold_off", threshold_off, {"ln", 0.01, 10, "fall that makes a negative event"});
  fields.add("threshold_sigma", threshold_sigma, {"ln", 0, 1, "spread of the thresholds over the pixels"});
  fields.add("refractory_us", refractory_us, {"us", 0, 1e6, "refractory time of a pixel after an event"});
  fields.add("bandwidth_hz", bandwidth_hz,
             {"Hz", 0, 1e6, "of the pixel's front-end in the dark; 0: unlimited, or none but for the next"});
  fields.add("bandwidth_per_radiance_hz", bandwidth_per_radiance_hz,
             {"Hz", 0, 1e6, "what a white spot in good light adds to it; 0: it does not depend on light"});
  fields.add("leak_hz", leak_hz, {"Hz", 0, 1e3, "positive events of a pixel in still light"});
  fields.add("shot_hz", shot_hz, {"Hz", 0, 1e3, "random events of a pixel, of either sign"});
  fields.add("hot_pixels", hot_pixels, {"", 0, 100000, "pixels that fire by themselves"});
  fields.add("hot_hz", hot_hz, {"Hz", 0.001, 1e4, "highest rate of a hot pixel; the lowest is a tenth of it"});
  fields.add("dark_radiance", dark_radiance,
             {"", 1e-6, 1, "added to every pixel's light; lowers the contrast in the dark"});
}

EventCamera::EventCamera(const EventCameraConfig& config, int width, int height, std::uint64_t seed)
    : config_(config), width_(width), random_(seed, 3), hot_random_(seed, 6), storm_random_(seed, 9) {
  const std::size_t n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  on_.resize(n), off_.resize(n), level_.resize(n), before_.resize(n), reference_.resize(n), target_.resize(n);
  crossed_.resize(n);
  last_ns_.assign(n, std::numeric_limits<std::int64_t>::min() / 2);
  const auto draw = [&](double mean) {
    return static_cast<float>(std::max(0.25 * mean, mean + config.threshold_sigma * random_.normal()));
  };
  for (std::size_t i = 0; i < n; ++i) on_[i] = draw(config.threshold_on), off_[i] = draw(config.threshold_off);
  for (int i = 0; i < config.hot_pixels; ++i) {
    const std::size_t pixel = static_cast<std::size_t>(hot_random_.index(static_cast<int>(n)));
    hot_.push_back({pixel, config.hot_hz * std::pow(0.1, hot_random_.uniform())});
  }
}

std::vector<Event> EventCamera::update(Timestamp t, std::span<const float> radiance, double storm_hz) {
  EDGED_CHECK(radiance.size() == level_.size(), "{} pixels instead of {}", radiance.size(), level_.size());
  const std::size_t n = level_.size();
  const float dark = static_cast<float>(config_.dark_radiance);
  for (std::size_t i = 0; i < n; ++i) target_[i] = log_brightness(radiance[i] + dark);
  if (!started_) {
    started_ = true, t_ = t;
    level_ = target_;
    // The phase of a pixel at the start of the recording is random.
    for (std::size_t i = 0; i < n; ++i)
      reference_[i] = level_[i] + static_cast<float>(random_.uniform(-0.99, 0.99)) * std::min(on_[i], off_[i]);
    return {};
  }
  EDGED_CHECK(t > t_, "picture at {} ns after {} ns", to_ns(t), to_ns(t_));
  const Interval interval{to_ns(t_), (t - t_).count()};
  const double dt = to_seconds(t - t_);
  const float leak = static_cast<float>(config_.leak_hz * dt);
  std::vector<Event> events;
  before_.swap(level_);
  follow(radiance, dt);
  mark_crossings(leak);
  const char *const first = crossed_.data(), *const end = first + n;
  const auto next = [end](const char* from) { return static_cast<const char*>(std::memchr(from, 1, end - from)); };
  for (const char* i = next(first); i != nullptr; i = next(i + 1))
    step_pixel(static_cast<std::size_t>(i - first), interval, events);
  add_shot_noise(interval, events);
  add_hot_pixels(interval, events);
  if (storm_hz > 0.0) add_storm(interval, storm_hz, events);
  sort(events);
  t_ = t;
  return events;
}

void EventCamera::sort(std::vector<Event>& events) {
  // By twelve bits of the microseconds at a time: between two pictures, that is all of them.
  constexpr int kBits = 12;
  const auto [first, last] = std::ranges::minmax_element(events, {}, &Event::t);
  if (first == events.end()) return;
  const std::int64_t begin = to_ns(first->t), span_us = (to_ns(last->t) - begin) / 1000;
  for (int shift = 0; span_us >> shift > 0; shift += kBits) {
    const auto part = [=](const Event& event) {
      return static_cast<std::size_t>((to_ns(event.t) - begin) / 1000 >> shift) & ((std::size_t{1} << kBits) - 1);
    };
    std::array<std::uint32_t, (std::size_t{1} << kBits) + 1> place{};
    for (const Event& event : events) ++place[part(event) + 1];
    std::partial_sum(place.begin(), place.end(), place.begin());
    sorted_.resize(events.size());
    for (const Event& event : events) sorted_[place[part(event)]++] = event;
    events.swap(sorted_);
  }
}

void EventCamera::follow(std::span<const float> radiance, double dt) {
  if (config_.bandwidth_per_radiance_hz > 0.0) {
    // Implicit Euler, which is stable for any step.
    const float base = static_cast<float>(2.0 * std::numbers::pi * config_.bandwidth_hz * dt);
    const float slope = static_cast<float>(2.0 * std::numbers::pi * config_.bandwidth_per_radiance_hz * dt);
    for (std::size_t i = 0; i < level_.size(); ++i) {
      const float x = base + slope * radiance[i];
      level_[i] = before_[i] + x / (1.0F + x) * (target_[i] - before_[i]);
    }
  } else if (config_.bandwidth_hz > 0.0) {
    const float gain = static_cast<float>(1.0 - std::exp(-2.0 * std::numbers::pi * config_.bandwidth_hz * dt));
    for (std::size_t i = 0; i < level_.size(); ++i) level_[i] = before_[i] + gain * (target_[i] - before_[i]);
  } else {
    level_.swap(target_);
  }
}

void EventCamera::mark_crossings(float leak) {
  // Pointers, as a char may lie anywhere, and no branch: for the compiler to take several pixels at a time.
  const float *const level = level_.data(), *const on = on_.data(), *const off = off_.data();
  float* const reference = reference_.data();
  char* const crossed = crossed_.data();
  for (std::size_t i = 0, n = level_.size(); i < n; ++i) {
    reference[i] -= leak * on[i];
    const float change = level[i] - reference[i];
    crossed[i] = (change >= on[i]) | (change <= -off[i]);
  }
}

void EventCamera::step_pixel(std::size_t pixel, const Interval& interval, std::vector<Event>& events) {
  const float before = before_[pixel], after = level_[pixel];
  const bool positive = after > reference_[pixel];
  const float step = positive ? on_[pixel] : -off_[pixel];
  const auto crossed = [&] { return positive ? after - reference_[pixel] >= step : after - reference_[pixel] <= step; };
  while (crossed()) {
    reference_[pixel] += step;
    const double share =
        after == before ? 1.0 : std::clamp((reference_[pixel] - before) / (after - before), 0.0F, 1.0F);
    // In its refractory time, a pixel adopts the new level without an event.
    fire(pixel, interval.at(share), positive, events);
  }
}

void EventCamera::add_shot_noise(const Interval& interval, std::vector<Event>& events) {
  const double expected =
      config_.shot_hz * static_cast<double>(interval.length_ns) * 1e-9 * static_cast<double>(level_.size());
  for (int count = random_.arrivals(expected); count > 0; --count) {
    const std::size_t pixel = static_cast<std::size_t>(random_.index(static_cast<int>(level_.size())));
    const std::int64_t t_ns = interval.at(random_.uniform());
    const bool positive = random_.uniform() < 0.5;
    if (fire(pixel, t_ns, positive, events)) reference_[pixel] = level_[pixel];
  }
}

void EventCamera::add_hot_pixels(const Interval& interval, std::vector<Event>& events) {
  for (const HotPixel& hot : hot_) {
    for (int count = hot_random_.arrivals(hot.hz * static_cast<double>(interval.length_ns) * 1e-9); count > 0;
         --count) {
      events.push_back(make_event(hot.pixel, interval.at(hot_random_.uniform()), true));
    }
  }
}

void EventCamera::add_storm(const Interval& interval, double hz, std::vector<Event>& events) {
  // More events are sampled, in time order, to replace those within a refractory time.
  const double drawn_hz = hz / std::max(0.1, 1.0 - hz * config_.refractory_us * 1e-6);
  const double length_ns = static_cast<double>(interval.length_ns);
  const int count = storm_random_.arrivals(drawn_hz * length_ns * 1e-9 * static_cast<double>(level_.size()));
  for (int k = 0; k < count; ++k) {
    const std::size_t pixel = static_cast<std::size_t>(storm_random_.index(static_cast<int>(level_.size())));
    const std::int64_t t_ns = interval.at((k + storm_random_.uniform()) / count);
    const bool positive = storm_random_.uniform() < 0.5;
    fire(pixel, t_ns, positive, events);
  }
}

bool EventCamera::fire(std::size_t pixel, std::int64_t t_ns, bool positive, std::vector<Event>& events) {
  if (static_cast<double>(t_ns - last_ns_[pixel]) < config_.refractory_us * 1e3) return false;
  last_ns_[pixel] = t_ns;
  events.push_back(make_event(pixel, t_ns, positive));
  return true;
}

Event EventCamera::make_event(std::size_t pixel, std::int64_t t_ns, bool positive) const {
  const std::size_t w = static_cast<std::size_t>(width_);
  return {timestamp_from_ns(t_ns / 1000 * 1000), static_cast<std::uint16_t>(pixel % w),
          static_cast<std::uint16_t>(pixel / w), positive};
}

}  // namespace edged
