// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The compressions of HDF5 that are no part of the library, so that files open without plugins to install.
#pragma once

#include <array>
#include <cstddef>

#include "edged/io/bytes.hpp"

namespace edged {

/// Their numbers as registered with the HDF Group.
enum class H5Filter : int { Lzf = 32000, Blosc = 32001, Zstd = 32015, Ecf = 0x8ecf };

/// A chunk as it was before the filter. chunk_bytes: the size of a chunk as the data set has it. Throws Damage for
/// anything that is not at least as long and for what is far longer.
Bytes undo_h5_filter(H5Filter filter, ByteSpan packed, std::size_t chunk_bytes);

/// Makes the filters known to the library, once. Blosc packs and unpacks, the others only unpack.
void register_h5_filters();

/// Tells the filters how long the chunks are that this thread reads, as the library does not check what they return.
/// A filter refuses to unpack outside of such a scope.
class H5ChunkScope {
 public:
  explicit H5ChunkScope(std::size_t chunk_bytes);
  ~H5ChunkScope();
  H5ChunkScope(const H5ChunkScope&) = delete;
  H5ChunkScope& operator=(const H5ChunkScope&) = delete;
};

/// The parameters of Blosc for values of so many bytes: Zstandard behind a shuffle of bytes.
std::array<unsigned, 7> blosc_parameters(std::size_t value_bytes, std::size_t chunk_bytes);

}  // namespace edged
