// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compression and decompression of recordings, one block at a time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "edged/io/archive/bytes.hpp"

namespace edged {

struct Decompressed {
  Bytes bytes;
  bool whole = false;  ///< false: damaged or cut; `bytes` holds what precedes it
};

/// method: "none" or "", "lz4" (LZ4 frames), "bz2" or "zstd". More than max_bytes counts as damage, so that damaged
/// lengths cannot fill the memory. Throws Damage for another method.
Decompressed decompress(std::string_view method, ByteSpan packed, std::size_t max_bytes);

/// Decompresses a file of one or several zstd frames into a new file, in bounded memory. Returns false if it is damaged
/// or cut: then the new file holds what precedes the damage. Throws InputError if the new file cannot be written.
bool decompress_zstd_file(const std::filesystem::path& packed, const std::filesystem::path& unpacked);

/// method: "none" or "", "lz4" (a frame of independent blocks with a checksum, which ROS reads, too) or "zstd" (with a
/// checksum). Throws Damage for another method.
std::string compress(std::string_view method, std::string_view bytes);

/// How messages are collected in chunks.
struct ChunkOptions {
  std::string_view compression;    ///< as in compress(); each container supports some of them
  std::size_t bytes = 768 * 1024;  ///< a chunk is closed once its records are longer
};

}  // namespace edged
