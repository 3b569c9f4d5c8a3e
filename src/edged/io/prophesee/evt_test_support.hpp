// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Encoders of the Prophesee formats, for tests, fuzzing and benchmarks.
#pragma once

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "edged/io/bytes.hpp"
#include "edged/io/prophesee/evt.hpp"

namespace edged {

/// Events in time order with rows of neighbours, so that the vector words of EVT 2.1 and 3 have something to say.
/// Stamps are whole microseconds.
inline std::vector<Event> generated_events(std::size_t count, int width, int height, std::int64_t mean_step_us) {
  std::mt19937_64 random(7);
  const auto below = [&random](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<unsigned>(n));
  };
  std::vector<Event> events;
  std::int64_t t_us = 1000;
  while (events.size() < count) {
    t_us += below(2 * mean_step_us + 1);
    const std::int64_t y = below(height), x = below(width), run = 1 + below(40);
    const bool positive = below(2) == 1;
    for (std::int64_t i = 0; i < run && x + i < width && events.size() < count; i += 1 + below(3))
      events.push_back(
          {timestamp_from_ns(t_us * 1000), static_cast<std::uint16_t>(x + i), static_cast<std::uint16_t>(y), positive});
  }
  return events;
}

/// Writes events in time order as a sensor would.
class EvtEncoder {
 public:
  explicit EvtEncoder(EvtFormat format) : format_(format) {}

  std::string encode(const std::vector<Event>& events) {
    bytes_.clear();
    for (std::size_t i = 0; i < events.size();) i = write_row(events, i);
    return bytes_;
  }

 private:
  /// Events from `first` on that have stamp, row and polarity in common and lie within 32 columns become one group.
  std::size_t write_row(const std::vector<Event>& events, std::size_t first) {
    const Event& a = events[first];
    std::uint32_t mask = 1;
    std::size_t last = first + 1;
    for (; last < events.size(); ++last) {
      const Event &b = events[last], &before = events[last - 1];
      if (b.t != a.t || b.y != a.y || b.positive != a.positive || b.x <= before.x || b.x >= a.x + 32) break;
      mask |= 1u << (b.x - a.x);
    }
    const std::uint64_t t_us = static_cast<std::uint64_t>(to_ns(a.t) / 1000);
    if (format_ == EvtFormat::Evt3) {
      write_evt3(a, t_us, mask);
    } else if (format_ == EvtFormat::Evt21 || format_ == EvtFormat::Evt21Legacy) {
      write_evt21(a, t_us, mask);
    } else {
      for (std::size_t i = first; i < last; ++i) write_single(events[i], t_us);
    }
    return last;
  }

  void write_single(const Event& e, std::uint64_t t_us) {
    if (format_ == EvtFormat::Dat) {
      put(static_cast<std::uint32_t>(t_us));
      put(static_cast<std::uint32_t>(e.x | e.y << 14 | e.positive << 28));
      return;
    }
    if (t_us >> 6 != high_) put(static_cast<std::uint32_t>(0x8u << 28 | (t_us >> 6 & 0xFFFFFFF)));
    high_ = t_us >> 6;
    put(static_cast<std::uint32_t>((e.positive ? 0x1u << 28 : 0u) | (t_us & 63) << 22 | unsigned{e.x} << 11 | e.y));
  }

  void write_evt21(const Event& e, std::uint64_t t_us, std::uint32_t mask) {
    if (t_us >> 6 != high_) put21(0x8ull << 60 | (t_us >> 6 & 0xFFFFFFF) << 32);
    high_ = t_us >> 6;
    put21(std::uint64_t{e.positive} << 60 | (t_us & 63) << 54 | std::uint64_t{e.x} << 43 | std::uint64_t{e.y} << 32 |
          mask);
  }

  void write_evt3(const Event& e, std::uint64_t t_us, std::uint32_t mask) {
    const unsigned polarity = e.positive ? 0x800u : 0u;
    if (t_us >> 12 != high_) put3(0x8, t_us >> 12 & 0xFFF);
    high_ = t_us >> 12;
    put3(0x6, t_us & 0xFFF);
    put3(0x0, e.y);
    if (mask == 1) return put3(0x2, e.x | polarity);
    put3(0x3, e.x | polarity);
    put3(0x4, mask & 0xFFF);
    put3(0x4, mask >> 12 & 0xFFF);
    put3(0x5, mask >> 24);
  }

  void put3(unsigned type, std::uint64_t payload) { put(static_cast<std::uint16_t>(type << 12 | payload)); }

  void put21(std::uint64_t word) { put(format_ == EvtFormat::Evt21Legacy ? word << 32 | word >> 32 : word); }

  template <typename Word>
  void put(Word word) {
    char raw[sizeof word];
    std::memcpy(raw, &word, sizeof word);
    bytes_.append(raw, sizeof word);
  }

  EvtFormat format_;
  std::uint64_t high_ = ~std::uint64_t{0};  ///< upper part of the time last written
  std::string bytes_;
};

}  // namespace edged
