// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ECF, the packing of events in the HDF5 files of Prophesee's Metavision.
#pragma once

#include <cstdint>
#include <vector>

#include "edged/io/bytes.hpp"

namespace edged {

/// One event as a row of /CD/events lies in memory.
struct EcfEvent {
  std::uint16_t x = 0, y = 0;  ///< [px]
  std::int16_t p = 0;          ///< 1: brighter
  std::int16_t unused = 0;
  std::int64_t t = 0;  ///< [us]

  bool operator==(const EcfEvent&) const = default;
};
static_assert(sizeof(EcfEvent) == 16);

/// One chunk of events. Throws Damage when it ends too early, contradicts itself or says to hold more than max_events.
std::vector<EcfEvent> decode_ecf(ByteSpan packed, std::size_t max_events);

}  // namespace edged
