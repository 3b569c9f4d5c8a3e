// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Decodes the formats of Prophesee sensors: EVT 2.0, 2.1 and 3.0, and the records of DAT files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

enum class EvtFormat {
  Evt2,         ///< words of 32 bits, one event each
  Evt21,        ///< words of 64 bits, up to 32 events of one row each
  Evt21Legacy,  ///< the same, the upper half sent first (IMX636)
  Evt3,         ///< words of 16 bits that change a state; up to 12 events each
  Dat,          ///< records of 64 bits with their full time
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

  const Counts& counts() const { return counts_; }

 private:
  /// The state between two words.
  struct State {
    bool timed = false;               ///< the stream has given a time
    std::int64_t high = 0;            ///< upper part of the time, continued over wraps
    std::uint32_t low = 0;            ///< lower part [us], EVT 3 only
    std::uint32_t row = kNowhere;     ///< EVT 3 only
    std::uint32_t base_x = kNowhere;  ///< column of the next vector, EVT 3 only
    bool positive = false;            ///< polarity of the next vector, EVT 3 only
  };
  class Sink;
  static constexpr std::uint32_t kNowhere = 0x10000;  ///< outside every sensor

  template <typename Word, typename Step>
  void each_word(std::span<const std::uint8_t> bytes, const Step& step);
  static void evt2(std::uint32_t word, State& state, Sink& sink);
  static void evt21(std::uint64_t word, State& state, Sink& sink);
  static void evt3(std::uint16_t word, State& state, Sink& sink);
  static void dat(std::uint64_t word, State& state, Sink& sink);

  EvtFormat format_;
  std::uint32_t width_, height_;
  State state_;
  Counts counts_;
  std::array<std::uint8_t, 8> cut_{};  ///< the first bytes of a word that ends in the next chunk
  std::size_t cut_bytes_ = 0;
};

}  // namespace edged
