// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ECF, the packing of events in HDF5 files of Metavision by Prophesee.
#pragma once

#include <cstdint>
#include <vector>

#include "edged/io/archive/bytes.hpp"

namespace edged {

/// One event in the memory layout of a row of /CD/events.
struct EcfEvent {
  std::uint16_t x = 0, y = 0;  ///< [px]
  std::int16_t p = 0;          ///< 1: brighter
  std::int16_t unused = 0;
  std::int64_t t = 0;  ///< [us]

  bool operator==(const EcfEvent&) const = default;
};
static_assert(sizeof(EcfEvent) == 16);

/// Decodes one chunk of events. Throws Damage if it ends too early, is inconsistent or states more than max_events.
std::vector<EcfEvent> decode_ecf(ByteSpan packed, std::size_t max_events);

}  // namespace edged
