// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compression filters of HDF5 that are not part of the library, so that no plugins are needed.
#pragma once

#include <array>
#include <cstddef>

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

}  // namespace edged
