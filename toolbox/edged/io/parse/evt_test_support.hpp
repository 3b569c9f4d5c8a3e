// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events to encode and an encoder of all formats, for tests, fuzzing and benchmarks.
#pragma once

#include <bit>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/parse/evt.hpp"

namespace edged {

/// Events in time order with rows of neighbours, so that the vector words of EVT 2.1 and 3 are used.
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

/// Encodes events as EvtEncoder does, in any of the formats. Bits of the first stamp beyond the counter (EVT 2 and 4:
/// 34 bits) are lost, too.
class AnyEvtEncoder {
 public:
  explicit AnyEvtEncoder(EvtFormat format) : format_(format) {}

  const std::string& encode(std::span<const Event> events) {
    if (format_ == EvtFormat::Evt3 || format_ == EvtFormat::Dat) return plain_.encode(events);
    bytes_.clear();
    while (!events.empty()) events = events.subspan(write_row(events));
    return bytes_;
  }

 private:
  /// Writes the leading events: a group, or one of EVT 2. Returns their number.
  std::size_t write_row(std::span<const Event> events) {
    const Event& a = events.front();
    write_high(static_cast<std::uint64_t>(to_ns(a.t) / 1000) >> 6U);
    if (format_ == EvtFormat::Evt2) {
      append_number(bytes_, (a.positive ? 1U << 28U : 0U) | low_bits(a) | unsigned{a.x} << 11U | a.y);
      return 1;
    }
    const auto [count, mask] = leading_group(events);
    const std::uint32_t place = low_bits(a) | unsigned{a.x} << 11U | a.y;
    if (format_ == EvtFormat::Evt4) {
      append_number(bytes_, ((mask == 1 ? 0xAU : 0xCU) + (a.positive ? 1U : 0U)) << 28U | place);
      if (mask != 1) append_number(bytes_, mask);
    } else {
      put21(a.positive ? 1U : 0U, place, mask);
    }
    return count;
  }

  /// The upper part of the time, where it has changed.
  void write_high(std::uint64_t high) {
    if (std::exchange(high_, high) == high) return;
    const auto counter = static_cast<std::uint32_t>(high & 0xFFFFFFFU);
    if (format_ == EvtFormat::Evt2 || format_ == EvtFormat::Evt4)
      append_number(bytes_, (format_ == EvtFormat::Evt4 ? 0xEU : 0x8U) << 28U | counter);
    else
      put21(0x8U, counter, 0);
  }

  static std::uint32_t low_bits(const Event& e) {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(to_ns(e.t) / 1000) & 63U) << 22U;
  }

  void put21(std::uint32_t type, std::uint32_t upper, std::uint32_t lower) {
    const std::uint64_t word = std::uint64_t{type << 28U | upper} << 32U | lower;
    append_number(bytes_, format_ == EvtFormat::Evt21Legacy ? std::rotl(word, 32) : word);
  }

  EvtFormat format_;
  EvtEncoder plain_{format_ == EvtFormat::Dat ? EvtFormat::Dat : EvtFormat::Evt3};
  std::uint64_t high_ = ~std::uint64_t{0};  ///< upper part of the time last written
  std::string bytes_;
};

}  // namespace edged
