// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The compressions of recordings, one block at a time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "edged/io/bytes.hpp"

namespace edged {

struct Decompressed {
  Bytes bytes;
  bool whole = false;  ///< false: damaged or cut; `bytes` holds what came before
};

/// method: "none" or "", "lz4" (LZ4 frames), "bz2" or "zstd". More than max_bytes counts as damage, so that damaged
/// lengths cannot fill the memory. Throws Damage for another method.
Decompressed decompress(std::string_view method, ByteSpan packed, std::size_t max_bytes);

/// Unpacks a file of one zstd frame or several into a new one, in bounded memory; false where it is damaged or cut,
/// what came before is unpacked then. Throws InputError where the new file cannot be written.
bool decompress_zstd_file(const std::filesystem::path& packed, const std::filesystem::path& unpacked);

/// method: "none" or "", "lz4" (a frame of independent blocks with a checksum, which ROS reads, too) or "zstd" (with a
/// checksum). Throws Damage for another method.
std::string compress(std::string_view method, std::string_view bytes);

/// How messages are put together to chunks.
struct ChunkOptions {
  std::string_view compression;    ///< as in compress(); which ones a container knows is its own matter
  std::size_t bytes = 768 * 1024;  ///< a chunk is closed when its records are longer
};

}  // namespace edged
