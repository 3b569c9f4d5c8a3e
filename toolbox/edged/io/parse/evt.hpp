// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Decodes the formats of Prophesee sensors, EVT 2.0, 2.1, 3.0 and 4.0, and the records of DAT files; encodes EVT 3.0
// and DAT.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

enum class EvtFormat {
  Evt2,         ///< words of 32 bits, one event each
  Evt21,        ///< words of 64 bits, up to 32 events of one row each
  Evt21Legacy,  ///< EVT 2.1 with the upper half of a word sent first (IMX636)
  Evt3,         ///< words of 16 bits that change a state; up to 12 events each
  Dat,          ///< records of 64 bits with their full time
  Evt4,         ///< words of 32 bits, one event each, or two words for up to 32 events of one row
};

/// Decodes a stream of bytes into events. Chunks may end anywhere, also within a word. Stamps come from the
/// microseconds of the sensor, continued over wraps of its counter (EVT 3: every 16.8 s). They step back if those of
/// the stream do. Damage is counted and never throws.
class EvtDecoder {
 public:
  struct Counts {
    std::size_t outside = 0;  ///< events outside the sensor, left out
    std::size_t untimed = 0;  ///< events before the first time of the stream, left out
    std::size_t unknown = 0;  ///< words of types that the format does not have, ignored
  };

  /// width, height: of the sensor [px].
  EvtDecoder(EvtFormat format, int width, int height);

  /// Appends the events whose last byte is in `bytes`.
  void decode(std::span<const std::uint8_t> bytes, std::vector<Event>& events);

  /// Resets time, row and incomplete word, but not the counts. Needed after missing bytes, and for packets with a time
  /// base of their own.
  void reset();

  /// Goes back to the state of an earlier copy, but keeps the counts and the incomplete word.
  void return_to(const EvtDecoder& earlier) { state_ = earlier.state_; }

  const Counts& counts() const { return counts_; }

  /// Edges of one polarity of an external trigger input.
  struct Edges {
    std::size_t count = 0;
    std::int64_t first_us = 0, last_us = 0;
  };
  /// Channel of the trigger input to its falling and its rising edges.
  const std::map<std::uint32_t, std::array<Edges, 2>>& triggers() const { return triggers_; }

 private:
  /// The state between two words.
  struct State {
    bool timed = false;               ///< the stream has given a time
    std::int64_t high = 0;            ///< upper part of the time, continued over wraps
    std::uint32_t low = 0;            ///< lower part [us], EVT 3 only
    std::uint32_t row = kNowhere;     ///< EVT 3 only
    std::uint32_t base_x = kNowhere;  ///< column of the next vector, EVT 3 only
    bool positive = false;            ///< polarity of the next vector, EVT 3 only
    std::uint32_t vector = 0;         ///< word whose columns the next word holds, EVT 4 only
  };
  class Sink;
  static constexpr std::uint32_t kNowhere = 0x10000;  ///< outside every sensor

  template <typename Word, typename Step>
  void each_word(std::span<const std::uint8_t> bytes, const Step& step);
  static void evt2(std::uint32_t word, State& state, Sink& sink);
  static void evt21(std::uint64_t word, State& state, Sink& sink);
  static void evt3(std::uint16_t word, State& state, Sink& sink);
  static void evt4(std::uint32_t word, State& state, Sink& sink);
  static void dat(std::uint64_t word, State& state, Sink& sink);

  EvtFormat format_;
  std::uint32_t width_, height_;
  State state_;
  Counts counts_;
  std::map<std::uint32_t, std::array<Edges, 2>> triggers_;
  std::array<std::uint8_t, 8> cut_{};  ///< the first bytes of a word that ends in the next chunk
  std::size_t cut_bytes_ = 0;
};

/// Leading events with the same stamp, row and polarity within 32 columns: a word of them has a bit for each column.
struct EventGroup {
  std::size_t count;
  std::uint32_t mask;  ///< bit i: column of the first event + i
};
EventGroup leading_group(std::span<const Event> events);

/// Encodes events in time order as EVT 3 or DAT for EvtDecoder. Stamps are rounded down to microseconds. Bits of the
/// first stamp beyond the counter (EVT 3: 24 bits, DAT: 32) are lost, and later stamps continue from there. Columns and
/// rows have 11 bits (DAT: 14).
class EvtEncoder {
 public:
  explicit EvtEncoder(EvtFormat format);

  /// The bytes of these events; valid until the next call.
  const std::string& encode(std::span<const Event> events);

 private:
  std::size_t write_row(std::span<const Event> events);
  void write_evt3(const Event& e, std::uint64_t t_us, std::uint32_t mask);
  void put3(unsigned type, std::uint64_t payload);

  EvtFormat format_;
  std::uint64_t high_ = ~std::uint64_t{0};  ///< upper part of the time last written
  std::string bytes_;
};

}  // namespace edged
