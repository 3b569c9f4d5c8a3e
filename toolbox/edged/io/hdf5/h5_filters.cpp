// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A callback for each filter, and functions that are independent of the library.
#include "edged/io/hdf5/h5_filters.hpp"

#include <blosc.h>
#include <hdf5.h>
#include <lzf.h>

#include <cstring>

#include "edged/core/check.hpp"
#include "edged/io/archive/compression.hpp"

namespace edged {
namespace {

thread_local std::size_t chunk_bytes_read = 0;  // 0 outside a scope

Bytes undo_blosc(ByteSpan packed, std::size_t max_bytes) {
  std::size_t bytes = 0;
  if (blosc_cbuffer_validate(packed.data(), packed.size(), &bytes) != 0 || bytes > max_bytes)
    throw Damage("not a chunk of Blosc");
  Bytes out(bytes);
  if (blosc_decompress_ctx(packed.data(), out.data(), out.size(), 1) != static_cast<int>(bytes))
    throw Damage("Blosc cannot unpack a chunk");
  return out;
}

Bytes undo_zstd(ByteSpan packed, std::size_t max_bytes) {
  Decompressed out = decompress("zstd", packed, max_bytes);
  if (!out.whole) throw Damage("Zstandard cannot unpack a chunk");
  return std::move(out.bytes);
}

Bytes undo_lzf(ByteSpan packed, std::size_t max_bytes) {
  Bytes out(max_bytes);
  const unsigned bytes = lzf_decompress(packed.data(), static_cast<unsigned>(packed.size()), out.data(),
                                        static_cast<unsigned>(out.size()));
  if (bytes == 0) throw Damage("LZF cannot unpack a chunk");
  out.resize(bytes);
  return out;
}

Bytes undo_ecf(ByteSpan packed, std::size_t max_bytes) {
  const std::vector<EcfEvent> events = decode_ecf(packed, max_bytes / sizeof(EcfEvent));
  Bytes out(events.size() * sizeof(EcfEvent));
  if (!events.empty()) std::memcpy(out.data(), events.data(), out.size());
  return out;
}

/// Replaces the buffer of the library by `bytes`. Returns their number, which is 0 on failure.
std::size_t replace_buffer(const Bytes& bytes, std::size_t* buffer_size, void** buffer) {
  void* fresh = bytes.empty() ? nullptr : H5allocate_memory(bytes.size(), false);
  if (!fresh) return 0;
  std::memcpy(fresh, bytes.data(), bytes.size());
  H5free_memory(*buffer);
  *buffer = fresh;
  *buffer_size = bytes.size();
  return bytes.size();
}

Bytes apply_blosc(ByteSpan plain, std::size_t parameter_count, const unsigned* parameters) {
  if (parameter_count < 7) return {};
  Bytes packed(plain.size() + BLOSC_MAX_OVERHEAD);
  const int bytes =
      blosc_compress_ctx(static_cast<int>(parameters[4]), static_cast<int>(parameters[5]), parameters[2], plain.size(),
                         plain.data(), packed.data(), packed.size(), BLOSC_ZSTD_COMPNAME, 0, 1);
  packed.resize(bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
  return packed;
}

/// Called by the library, which is C: must not throw. Returns 0 on failure.
template <H5Filter filter>
std::size_t filter_callback(unsigned flags, std::size_t parameter_count, const unsigned* parameters, std::size_t bytes,
                            std::size_t* buffer_size, void** buffer) noexcept try {
  const ByteSpan data(static_cast<const std::uint8_t*>(*buffer), bytes);
  if (flags & H5Z_FLAG_REVERSE)
    return replace_buffer(undo_h5_filter(filter, data, chunk_bytes_read), buffer_size, buffer);
  if (filter != H5Filter::Blosc) return 0;
  return replace_buffer(apply_blosc(data, parameter_count, parameters), buffer_size, buffer);
} catch (const std::exception&) {
  return 0;
}

template <H5Filter filter>
void register_filter(const char* name) {
  const H5Z_class2_t description{H5Z_CLASS_T_VERS, static_cast<H5Z_filter_t>(filter), 1, 1, name, nullptr,
                                 nullptr,          &filter_callback<filter>};
  EDGED_CHECK(H5Zregister(&description) >= 0, "filter {} of HDF5 cannot be registered", name);
}

}  // namespace

Bytes undo_h5_filter(H5Filter filter, ByteSpan packed, std::size_t chunk_bytes) {
  constexpr std::size_t kSlack = 64;  // for a checksum after the data
  if (chunk_bytes == 0 || packed.empty()) throw Damage("an empty chunk");
  const std::size_t most = chunk_bytes + kSlack;
  Bytes out = filter == H5Filter::Blosc  ? undo_blosc(packed, most)
              : filter == H5Filter::Zstd ? undo_zstd(packed, most)
              : filter == H5Filter::Lzf  ? undo_lzf(packed, most)
                                         : undo_ecf(packed, most);
  if (out.size() < chunk_bytes) throw Damage("a chunk that is too short");
  return out;
}

void register_h5_filters() {
  static const bool registered = [] {
    register_filter<H5Filter::Lzf>("lzf");
    register_filter<H5Filter::Blosc>("blosc");
    register_filter<H5Filter::Zstd>("zstd");
    register_filter<H5Filter::Ecf>("ecf");
    return true;
  }();
  std::ignore = registered;
}

H5ChunkScope::H5ChunkScope(std::size_t chunk_bytes) { chunk_bytes_read = chunk_bytes; }
H5ChunkScope::~H5ChunkScope() { chunk_bytes_read = 0; }

std::array<unsigned, 7> blosc_parameters(std::size_t value_bytes, std::size_t chunk_bytes) {
  constexpr unsigned kFilterRevision = 2, kLevel = 5;
  return {kFilterRevision,
          BLOSC_VERSION_FORMAT,
          static_cast<unsigned>(value_bytes),
          static_cast<unsigned>(chunk_bytes),
          kLevel,
          BLOSC_SHUFFLE,
          BLOSC_ZSTD};
}

}  // namespace edged
