// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Encodes the words of each format, the inverse of EvtDecoder.
#include "edged/io/parse/evt_encoder.hpp"

#include <algorithm>
#include <bit>

#include "edged/io/archive/bytes.hpp"

namespace edged {

const std::string& EvtEncoder::encode(std::span<const Event> events) {
  bytes_.clear();
  while (!events.empty()) events = events.subspan(write_row(events));
  return bytes_;
}

/// The number of leading events with the same stamp, row and polarity within 32 columns. They become one group.
std::size_t EvtEncoder::write_row(std::span<const Event> events) {
  const Event& a = events.front();
  std::uint32_t mask = 1;
  std::size_t count = 1;
  for (; count < events.size(); ++count) {
    const Event &b = events[count], &before = events[count - 1];
    if (b.t != a.t || b.y != a.y || b.positive != a.positive || b.x <= before.x || b.x >= a.x + 32) break;
    mask |= 1U << (b.x - a.x);
  }
  const auto t_us = static_cast<std::uint64_t>(to_ns(a.t) / 1000);
  if (format_ == EvtFormat::Evt3) {
    write_evt3(a, t_us, mask);
  } else if (format_ == EvtFormat::Evt21 || format_ == EvtFormat::Evt21Legacy) {
    write_evt21(a, t_us, mask);
  } else {
    for (const Event& event : events.first(count)) write_single(event, t_us);
  }
  return count;
}

void EvtEncoder::write_single(const Event& e, std::uint64_t t_us) {
  if (format_ == EvtFormat::Dat) {
    append_number(bytes_, static_cast<std::uint32_t>(t_us));
    append_number(bytes_, static_cast<std::uint32_t>(e.x | e.y << 14 | e.positive << 28));
    return;
  }
  if (t_us >> 6 != high_) append_number(bytes_, static_cast<std::uint32_t>(0x8U << 28 | (t_us >> 6 & 0xFFFFFFF)));
  high_ = t_us >> 6;
  append_number(bytes_, static_cast<std::uint32_t>((e.positive ? 0x1U << 28 : 0U) | (t_us & 63) << 22 |
                                                   unsigned{e.x} << 11 | e.y));
}

void EvtEncoder::write_evt21(const Event& e, std::uint64_t t_us, std::uint32_t mask) {
  if (t_us >> 6 != high_) put21(0x8ULL << 60 | (t_us >> 6 & 0xFFFFFFF) << 32);
  high_ = t_us >> 6;
  put21(std::uint64_t{e.positive} << 60 | (t_us & 63) << 54 | std::uint64_t{e.x} << 43 | std::uint64_t{e.y} << 32 |
        mask);
}

void EvtEncoder::write_evt3(const Event& e, std::uint64_t t_us, std::uint32_t mask) {
  constexpr std::uint64_t kLongestStep = 1024;  // of 4096: a longer step over the wrap decodes as a step backwards
  const std::uint64_t high = t_us >> 12;
  if (high_ != ~std::uint64_t{0})
    while (high > high_ && high - high_ > kLongestStep) put3(0x8, (high_ += kLongestStep) & 0xFFF);
  if (high != high_) put3(0x8, high & 0xFFF);
  high_ = high;
  const unsigned polarity = e.positive ? 0x800U : 0U;
  put3(0x6, t_us & 0xFFF);
  put3(0x0, e.y);
  if (std::popcount(mask) < 3) {  // single words are shorter
    for (; mask; mask &= mask - 1) put3(0x2, (e.x + static_cast<unsigned>(std::countr_zero(mask))) | polarity);
    return;
  }
  put3(0x3, e.x | polarity);
  put3(0x4, mask & 0xFFF);
  if (mask >> 12) put3(0x4, mask >> 12 & 0xFFF);
  if (mask >> 24) put3(0x5, mask >> 24);
}

void EvtEncoder::put3(unsigned type, std::uint64_t payload) {
  append_number(bytes_, static_cast<std::uint16_t>(type << 12 | payload));
}

void EvtEncoder::put21(std::uint64_t word) {
  append_number(bytes_, format_ == EvtFormat::Evt21Legacy ? std::rotl(word, 32) : word);
}

}  // namespace edged
