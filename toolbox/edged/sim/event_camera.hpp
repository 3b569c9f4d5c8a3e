// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An event camera: a pixel fires when the logarithm of its brightness has changed by its threshold.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

class EventCamera {
 public:
  EventCamera(const EventCameraConfig& config, int width, int height, std::uint64_t seed);

  /// The events between the previous picture and this one, in time order, with stamps in whole microseconds. The
  /// brightness is assumed to be linear in time in between. The first picture gives no events. radiance: width x
  /// height, linear. t must increase. storm_hz: rate per pixel of additional events of either sign, independent of the
  /// light.
  std::vector<Event> update(Timestamp t, std::span<const float> radiance, double storm_hz = 0.0);

 private:
  struct Interval {
    std::int64_t begin_ns, length_ns;
  };
  void step_pixel(std::size_t pixel, float before, const Interval& interval, std::vector<Event>& events);
  void add_shot_noise(const Interval& interval, std::vector<Event>& events);
  void add_storm(const Interval& interval, double hz, std::vector<Event>& events);
  void add_hot_pixels(const Interval& interval, std::vector<Event>& events);
  /// Moves level_ from before_ towards target_ for dt seconds.
  void follow(std::span<const float> radiance, double dt);
  Event make_event(std::size_t pixel, std::int64_t t_ns, bool positive) const;

  EventCameraConfig config_;
  int width_;
  Random random_;
  Random hot_random_, storm_random_;
  struct HotPixel {
    std::size_t pixel;
    double hz;
  };
  std::vector<HotPixel> hot_;
  std::vector<float> on_, off_;           // thresholds
  std::vector<float> level_, reference_;  // log brightness: now, and at the last event
  std::vector<float> target_;             // log brightness without the limited bandwidth
  std::vector<float> before_;             // level_ at the previous picture
  std::vector<std::int64_t> last_ns_;     // of the last event
  Timestamp t_;
  bool started_ = false;
};

/// Natural logarithm of x > 0, accurate to 1e-6, with the same bits on every machine.
float log_brightness(float x);

}  // namespace edged
