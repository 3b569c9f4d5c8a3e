// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compression filters of HDF5 that are not part of the library, so that no plugins are needed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "edged/io/archive/bytes.hpp"

namespace edged {

/// The numbers of the filters, as registered with the HDF Group.
enum class H5Filter : int { Lzf = 32000, Blosc = 32001, Zstd = 32015, Ecf = 0x8ecf };

/// Decompresses a chunk. chunk_bytes: the size of a chunk of the data set. Throws Damage if the result is shorter or
/// far longer.
Bytes undo_h5_filter(H5Filter filter, ByteSpan packed, std::size_t chunk_bytes);

/// Registers the filters with the library, once. Blosc compresses and decompresses, the others only decompress.
void register_h5_filters();

/// Sets the size of the chunks that this thread reads, as the library does not check what the filters return. Outside
/// such a scope, filters fail.
class H5ChunkScope {
 public:
  explicit H5ChunkScope(std::size_t chunk_bytes);
  ~H5ChunkScope();
  H5ChunkScope(const H5ChunkScope&) = delete;
  H5ChunkScope& operator=(const H5ChunkScope&) = delete;
};

/// The parameters of Blosc for values of this many bytes: a byte shuffle, then Zstandard.
std::array<unsigned, 7> blosc_parameters(std::size_t value_bytes, std::size_t chunk_bytes);

// ECF, the packing of events in HDF5 files of Metavision by Prophesee.

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
