// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files and checksums for the fuzz targets: what lies behind a checksum is reached only if it is right.
#pragma once

#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdlib>
#include <string>

#include "edged/core/check.hpp"
#include "edged/io/archive/bytes.hpp"

namespace edged {

/// A file in memory, with a name to open it by: one at a time.
inline std::string file_of(std::string_view bytes) {
  spdlog::set_level(spdlog::level::off);
  static const int file = memfd_create("fuzz", 0);
  const auto length = static_cast<ssize_t>(bytes.size());
  if (ftruncate(file, 0) != 0 || pwrite(file, bytes.data(), bytes.size(), 0) != length) std::abort();
  return "/proc/self/fd/" + std::to_string(file);
}

/// As PNG and SQLite write a number: the highest byte first.
inline std::string big_endian(std::uint32_t number) {
  const std::uint32_t swapped = __builtin_bswap32(number);
  return {reinterpret_cast<const char*>(&swapped), sizeof swapped};
}

inline std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, as_bytes(bytes).data(), bytes.size()));
}

}  // namespace edged
