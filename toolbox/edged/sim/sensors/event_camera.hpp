// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An event camera: a pixel fires when the logarithm of its brightness has changed by its threshold.
#pragma once

#include <bit>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// Natural logarithm of x > 0, accurate to 1e-6, with the same bits on every machine.
inline float log_brightness(float x) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)); ln m = 2 atanh((m - 1) / (m + 1)) as a series.
  constexpr std::uint32_t kSqrtHalf = 0x3F3504F3U;
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x) - kSqrtHalf;
  const float exponent = static_cast<float>(static_cast<std::int32_t>(bits) >> 23);
  const float m = std::bit_cast<float>((bits & 0x007FFFFFU) + kSqrtHalf);
  const float s = (m - 1.0F) / (m + 1.0F), s2 = s * s;
  const float series = 2.0F + s2 * (2.0F / 3.0F + s2 * (2.0F / 5.0F + s2 * (2.0F / 7.0F)));
  return exponent * std::numbers::ln2_v<float> + s * series;
}

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
    std::int64_t at(double share) const {
      return begin_ns + static_cast<std::int64_t>(share * static_cast<double>(length_ns));
    }
  };
  /// False in the refractory time of the pixel, without an event.
  bool fire(std::size_t pixel, std::int64_t t_ns, bool positive, std::vector<Event>& events);
  /// Lets the references leak, and sets crossed_.
  void mark_crossings(float leak);
  void step_pixel(std::size_t pixel, const Interval& interval, std::vector<Event>& events);
  void add_shot_noise(const Interval& interval, std::vector<Event>& events);
  void add_storm(const Interval& interval, double hz, std::vector<Event>& events);
  void add_hot_pixels(const Interval& interval, std::vector<Event>& events);
  /// Moves level_ from before_ towards target_ for dt seconds.
  void follow(std::span<const float> radiance, double dt);
  /// By time; those of one time stay in their order.
  void sort(std::vector<Event>& events);
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
  std::vector<char> crossed_;             // 1 where a threshold has been crossed since the last picture
  std::vector<std::int64_t> last_ns_;     // of the last event
  std::vector<Event> sorted_;             // what sort() sorts into
  Timestamp t_;
  bool started_ = false;
};

}  // namespace edged
