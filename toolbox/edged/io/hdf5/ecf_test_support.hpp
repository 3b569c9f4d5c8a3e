// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Packs events as Metavision does, for the tests.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "edged/io/hdf5/h5_filters.hpp"

namespace edged {

enum class EcfPacking : std::uint32_t { Runs = 0, ColumnsSideBySide = 1, AllSideBySide = 2 };

class EcfPacker {
 public:
  EcfPacker(std::span<const EcfEvent> events, EcfPacking packing) : events_(events) {
    put(static_cast<std::uint32_t>(events.size()) << 2U | static_cast<std::uint32_t>(packing));
    put_stamps();
    if (packing == EcfPacking::AllSideBySide) {
      put_side_by_side<std::uint32_t>([](const EcfEvent& e) { return e.y << 12 | e.x << 1 | e.p; });
      return;
    }
    put_runs<std::uint16_t, 31>([](const EcfEvent& e) { return e.y; });
    if (packing == EcfPacking::ColumnsSideBySide) {
      put_side_by_side<std::uint16_t>([](const EcfEvent& e) { return e.x << 1 | e.p; });
    } else {
      put_columns();
      put_runs<std::uint8_t, 127>([](const EcfEvent& e) { return e.p; });
    }
  }

  const Bytes& bytes() const { return out_; }

 private:
  template <typename T>
  void put(T value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    out_.insert(out_.end(), bytes, bytes + sizeof(T));
  }

  /// The number of events from i on with the same value.
  template <typename Value>
  std::size_t run(std::size_t i, const Value& value) const {
    std::size_t end = i;
    while (end < events_.size() && end - i < 65535 && value(events_[end]) == value(events_[i])) ++end;
    return end - i;
  }

  void put_stamps() {
    std::int64_t t = events_.empty() ? 0 : events_.front().t;
    put(t);
    for (std::size_t i = 0; i < events_.size();) {
      std::int64_t step = events_[i].t - t;
      t = events_[i].t;
      if (step >= 15)
        for (; step > 0; step >>= 4) put(static_cast<std::uint8_t>(0xf0 | (step & 15)));
      const std::size_t count = run(i, [](const EcfEvent& e) { return e.t; });
      put(static_cast<std::uint8_t>(step << 4 | static_cast<std::int64_t>(std::min<std::size_t>(count, 15))));
      if (count >= 15) put(static_cast<std::uint16_t>(count));
      i += count;
    }
  }

  /// Each value with the number of events that have it; a word holds kMost, and from there on the number follows.
  template <typename Word, std::size_t kMost, typename Value>
  void put_runs(const Value& value) {
    for (std::size_t i = 0; i < events_.size();) {
      const std::size_t count = run(i, value);
      put(static_cast<Word>(static_cast<std::size_t>(value(events_[i])) * (kMost + 1) + std::min(count, kMost)));
      if (count >= kMost) put(static_cast<std::uint16_t>(count));
      i += count;
    }
  }

  void put_columns() {
    for (std::size_t i = 0; i < events_.size();) {
      const int x = events_[i++].x;
      int word = x << 5;
      for (int step = 1; step <= 5 && i < events_.size(); ++step)
        if (events_[i].x == x + step) {
          word |= 1 << (5 - step);
          ++i;
        }
      put(static_cast<std::uint16_t>(word));
    }
  }

  template <typename Word, typename Bits>
  void put_side_by_side(const Bits& bits) {
    constexpr unsigned kQuarter = sizeof(Word) * 2;
    for (std::size_t i = 0; i < events_.size(); i += 4) {
      std::array<std::uint32_t, 4> v{};
      for (std::size_t k = 0; k < 4 && i + k < events_.size(); ++k)
        v[k] = static_cast<std::uint32_t>(bits(events_[i + k]));
      const auto low = [&](std::size_t k, unsigned quarters) { return v[k] & ((1U << quarters * kQuarter) - 1U); };
      put(static_cast<Word>(v[0] << kQuarter | low(1, 1)));
      put(static_cast<Word>(v[1] >> kQuarter << 2 * kQuarter | low(2, 2)));
      put(static_cast<Word>(v[2] >> 2 * kQuarter << 3 * kQuarter | low(3, 3)));
    }
  }

  std::span<const EcfEvent> events_;
  Bytes out_;
};

inline Bytes encode_ecf(std::span<const EcfEvent> events, EcfPacking packing) {
  return EcfPacker(events, packing).bytes();
}

}  // namespace edged
