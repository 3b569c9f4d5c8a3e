// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/evt.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/archive/bytes.hpp"

namespace edged {
namespace {

/// `count` bits of a word from bit `first` on.
template <typename Word>
constexpr std::uint32_t bits(Word word, unsigned first, unsigned count) {
  return static_cast<std::uint32_t>((word >> first) & ((Word{1} << count) - 1));
}

/// The time of a `counter` of `width` bits, the previous time being `last`. A step of clearly more than half the range
/// is a wrap. A flipped bit is never such a step, so the next counter restores the time.
std::int64_t continued(std::int64_t last, std::uint32_t counter, unsigned width) {
  const std::int64_t period = std::int64_t{1} << width, limit = period / 16 * 9;
  std::int64_t step = counter - (last & (period - 1));
  if (step > limit) step -= period;
  if (step < -limit) step += period;
  return last + step;
}

}  // namespace

/// Collects decoded events within the sensor, some at a time: to append each to a vector takes longer than to decode
/// it.
class EvtDecoder::Sink {
 public:
  Sink(EvtDecoder& decoder, std::vector<Event>& events)
      : width_(decoder.width_),
        height_(decoder.height_),
        counts_(decoder.counts_),
        triggers_(decoder.triggers_),
        events_(events) {}
  ~Sink() { flush(); }
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  void add(const State& state, std::int64_t t_us, std::uint32_t x, std::uint32_t y, bool positive) {
    if (x >= width_ || y >= height_) [[unlikely]] {
      ++counts_.outside;
    } else if (!state.timed) [[unlikely]] {
      ++counts_.untimed;
    } else {
      some_[count_++] = {timestamp_from_ns(t_us * 1000), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                         positive};
      if (count_ == some_.size()) [[unlikely]]
        flush();
    }
  }

  /// One event for each set bit of `mask`, from column x on.
  void add_row(const State& state, std::int64_t t_us, std::uint32_t x, std::uint32_t y, bool positive,
               std::uint32_t mask) {
    for (; mask; mask &= mask - 1)
      add(state, t_us, x + static_cast<std::uint32_t>(std::countr_zero(mask)), y, positive);
  }

  /// Updates the upper part of the time from a counter, in steps of 2^unit us. After a time beyond any recording, which
  /// damage causes, it starts again.
  void time_high(State& state, std::uint32_t counter, unsigned width, unsigned unit) {
    constexpr std::int64_t kLongest_us = std::int64_t{1} << 52;
    state.high = state.timed ? continued(state.high, counter, width) : counter;
    state.timed = std::abs(state.high) < kLongest_us >> unit;
  }

  /// Words without events: IMU of the camera (of undocumented unit), others, continued. Other types are in none of the
  /// formats and are counted.
  void no_change(std::uint32_t type) {
    if (type != 0xD && type != 0xE && type != 0xF) unknown();
  }
  void unknown() { ++counts_.unknown; }

  /// word: of 32 bits, as EVT 2 and 4 have it and EVT 2.1 in its upper half.
  void trigger(const State& state, std::uint32_t word) {
    trigger(state, state.high << 6 | bits(word, 22, 6), bits(word, 8, 5), bits(word, 0, 1));
  }
  [[gnu::noinline]] void trigger(const State& state, std::int64_t t_us, std::uint32_t channel, bool rising) {
    if (!state.timed) return;
    Edges& edges = triggers_[channel][rising ? 1 : 0];
    if (edges.count++ == 0) edges.first_us = t_us;
    edges.last_us = t_us;
  }

 private:
  [[gnu::noinline]] void flush() {
    events_.insert(events_.end(), some_.begin(), some_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ = 0;
  }

  const std::uint32_t width_, height_;
  Counts& counts_;
  std::map<std::uint32_t, std::array<Edges, 2>>& triggers_;
  std::vector<Event>& events_;
  std::array<Event, 512> some_;
  std::size_t count_ = 0;
};

EvtDecoder::EvtDecoder(EvtFormat format, int width, int height)
    : format_(format), width_(static_cast<std::uint32_t>(width)), height_(static_cast<std::uint32_t>(height)) {
  EDGED_CHECK(width > 0 && height > 0 && width <= 0x10000 && height <= 0x10000, "sensor {} x {}", width, height);
}

void EvtDecoder::reset() {
  state_ = State();
  cut_bytes_ = 0;
}

void EvtDecoder::decode(std::span<const std::uint8_t> bytes, std::vector<Event>& events) {
  Sink sink(*this, events);
  switch (format_) {
    case EvtFormat::Evt2:
      return each_word<std::uint32_t>(bytes, [&](auto word, State& state) { evt2(word, state, sink); });
    case EvtFormat::Evt21:
      return each_word<std::uint64_t>(bytes, [&](auto word, State& state) { evt21(word, state, sink); });
    case EvtFormat::Evt21Legacy:
      return each_word<std::uint64_t>(bytes, [&](auto word, State& state) { evt21(std::rotl(word, 32), state, sink); });
    case EvtFormat::Evt3:
      return each_word<std::uint16_t>(bytes, [&](auto word, State& state) { evt3(word, state, sink); });
    case EvtFormat::Dat:
      return each_word<std::uint64_t>(bytes, [&](auto word, State& state) { dat(word, state, sink); });
    case EvtFormat::Evt4:
      return each_word<std::uint32_t>(bytes, [&](auto word, State& state) { evt4(word, state, sink); });
  }
}

template <typename Word, typename Step>
void EvtDecoder::each_word(std::span<const std::uint8_t> bytes, const Step& step) {
  const auto each_of = [this, &step](const std::uint8_t* p, std::size_t size) {
    State state = state_;  // a local copy, which stays in registers
    for (const std::uint8_t* const end = p + size; p < end; p += sizeof(Word)) {
      Word word;
      std::memcpy(&word, p, sizeof word);
      step(word, state);
    }
    state_ = state;
  };
  const auto keep = [this, &bytes](std::size_t count) {
    std::copy_n(bytes.begin(), count, cut_.begin() + static_cast<std::ptrdiff_t>(cut_bytes_));
    cut_bytes_ += count;
    bytes = bytes.subspan(count);
  };
  if (cut_bytes_ > 0) {
    keep(std::min(bytes.size(), sizeof(Word) - cut_bytes_));
    if (cut_bytes_ < sizeof(Word)) return;
    each_of(cut_.data(), sizeof(Word));
    cut_bytes_ = 0;
  }
  const std::size_t whole = bytes.size() / sizeof(Word) * sizeof(Word);
  each_of(bytes.data(), whole);
  bytes = bytes.subspan(whole);
  keep(bytes.size());
}

[[gnu::always_inline]] inline void EvtDecoder::evt2(std::uint32_t word, State& state, Sink& sink) {
  switch (const std::uint32_t type = bits(word, 28, 4)) {
    case 0x0:  // darker
    case 0x1:  // brighter
      sink.add(state, state.high << 6 | bits(word, 22, 6), bits(word, 11, 11), bits(word, 0, 11), type == 0x1);
      break;
    case 0x8:
      sink.time_high(state, bits(word, 0, 28), 28, 6);
      break;
    case 0xA:
      sink.trigger(state, word);
      break;
    default:
      sink.no_change(type);
  }
}

[[gnu::always_inline]] inline void EvtDecoder::evt21(std::uint64_t word, State& state, Sink& sink) {
  switch (const std::uint32_t type = bits(word, 60, 4)) {
    case 0x0:
    case 0x1:
      sink.add_row(state, state.high << 6 | bits(word, 54, 6), bits(word, 43, 11), bits(word, 32, 11), type == 0x1,
                   bits(word, 0, 32));
      break;
    case 0x8:
      sink.time_high(state, bits(word, 32, 28), 28, 6);
      break;
    case 0xA:
      sink.trigger(state, bits(word, 32, 32));
      break;
    default:
      sink.no_change(type);
  }
}

[[gnu::always_inline]] inline void EvtDecoder::evt3(std::uint16_t word, State& state, Sink& sink) {
  const auto vector = [&](unsigned columns) {
    sink.add_row(state, state.high << 12 | state.low, state.base_x, state.row, state.positive, bits(word, 0, columns));
    state.base_x += columns;
  };
  switch (const std::uint32_t type = bits(word, 12, 4)) {
    case 0x0:
      state.row = bits(word, 0, 11);
      break;
    case 0x2:
      sink.add(state, state.high << 12 | state.low, bits(word, 0, 11), state.row, bits(word, 11, 1));
      break;
    case 0x3:
      state.base_x = bits(word, 0, 11);
      state.positive = bits(word, 11, 1);
      break;
    case 0x4:
      vector(12);
      break;
    case 0x5:
      vector(8);
      break;
    case 0x6:
      state.low = bits(word, 0, 12);
      break;
    case 0x8: {
      const std::int64_t before = state.high;
      sink.time_high(state, bits(word, 0, 12), 12, 12);
      if (state.high != before) state.low = 0;  // the lower part belongs to the previous upper part
      break;
    }
    case 0x7:  // continued
      break;
    case 0xA:
      sink.trigger(state, state.high << 12 | state.low, bits(word, 8, 4), bits(word, 0, 1));
      break;
    default:
      sink.no_change(type);
  }
}

/// The layout is that of the public headers of the manufacturer; no page describes it.
[[gnu::always_inline]] inline void EvtDecoder::evt4(std::uint32_t word, State& state, Sink& sink) {
  if (const std::uint32_t head = std::exchange(state.vector, 0))
    return sink.add_row(state, state.high << 6 | bits(head, 22, 6), bits(head, 11, 11), bits(head, 0, 11),
                        bits(head, 28, 1), word);
  switch (bits(word, 28, 4)) {
    case 0xA:  // darker
    case 0xB:  // brighter
      sink.add(state, state.high << 6 | bits(word, 22, 6), bits(word, 11, 11), bits(word, 0, 11), bits(word, 28, 1));
      break;
    case 0xC:
    case 0xD:
      state.vector = word;
      break;
    case 0xE:
      sink.time_high(state, bits(word, 0, 28), 28, 6);
      break;
    case 0x9:
      sink.trigger(state, word);
      break;
    case 0x6:  // others
    case 0x7:  // continued
      break;
    default:
      if (word != ~std::uint32_t{0}) sink.unknown();  // all bits set: padding
  }
}

[[gnu::always_inline]] inline void EvtDecoder::dat(std::uint64_t word, State& state, Sink& sink) {
  sink.time_high(state, bits(word, 0, 32), 32, 0);
  sink.add(state, state.high, bits(word, 32, 14), bits(word, 46, 14), bits(word, 60, 4) != 0);
}

EventGroup leading_group(std::span<const Event> events) {
  const Event& a = events.front();
  EventGroup group{1, 1};
  for (; group.count < events.size(); ++group.count) {
    const Event &b = events[group.count], &before = events[group.count - 1];
    if (b.t != a.t || b.y != a.y || b.positive != a.positive || b.x <= before.x || b.x >= a.x + 32) break;
    group.mask |= 1U << (b.x - a.x);
  }
  return group;
}

EvtEncoder::EvtEncoder(EvtFormat format) : format_(format) {
  EDGED_CHECK(format == EvtFormat::Evt3 || format == EvtFormat::Dat, "no encoder of this format");
}

const std::string& EvtEncoder::encode(std::span<const Event> events) {
  bytes_.clear();
  while (!events.empty()) events = events.subspan(write_row(events));
  return bytes_;
}

/// Writes the leading events: a group of EVT 3, or one of DAT. Returns their number.
std::size_t EvtEncoder::write_row(std::span<const Event> events) {
  const Event& a = events.front();
  const auto t_us = static_cast<std::uint64_t>(to_ns(a.t) / 1000);
  if (format_ == EvtFormat::Dat) {
    append_number(bytes_, static_cast<std::uint32_t>(t_us));
    append_number(bytes_, static_cast<std::uint32_t>(a.x | a.y << 14 | a.positive << 28));
    return 1;
  }
  const EventGroup group = leading_group(events);
  write_evt3(a, t_us, group.mask);
  return group.count;
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

}  // namespace edged
