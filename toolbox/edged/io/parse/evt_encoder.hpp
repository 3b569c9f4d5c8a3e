// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Encodes the formats of Prophesee sensors.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "edged/io/parse/evt.hpp"

namespace edged {

/// Encodes events in time order for EvtDecoder. Stamps are rounded down to microseconds. Bits of the first stamp beyond
/// the counter (EVT 3: 24 bits, EVT 2: 34, DAT: 32) are lost, and later stamps continue from there. Columns and rows
/// have 11 bits (DAT: 14).
class EvtEncoder {
 public:
  explicit EvtEncoder(EvtFormat format) : format_(format) {}

  /// The bytes of these events; valid until the next call.
  const std::string& encode(std::span<const Event> events);

 private:
  std::size_t write_row(std::span<const Event> events);
  void write_single(const Event& e, std::uint64_t t_us);
  void write_evt21(const Event& e, std::uint64_t t_us, std::uint32_t mask);
  void write_evt3(const Event& e, std::uint64_t t_us, std::uint32_t mask);
  void put3(unsigned type, std::uint64_t payload);
  void put21(std::uint64_t word);

  EvtFormat format_;
  std::uint64_t high_ = ~std::uint64_t{0};  ///< upper part of the time last written
  std::string bytes_;
};

}  // namespace edged
