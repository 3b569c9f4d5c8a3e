// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A callback for each filter, and functions that are independent of the library.
#include "edged/io/hdf5/h5_filters.hpp"

#include <blosc.h>
#include <hdf5.h>
#include <lzf.h>

#include <array>
#include <cstring>

#include "edged/core/check.hpp"
#include "edged/io/archive/compression.hpp"

namespace edged {
namespace {

// ECF. A chunk is one word (count and packing), the first stamp, then the stamps, rows, columns and polarities, each
// packed separately: stamps and rows as runs of equal values, columns as steps of up to five neighbours. If runs are
// longer, columns and polarities (12 bits), or these with the rows (24 bits), are stored for four events in three
// words.

constexpr std::uint32_t kColumnMask = 0x7ff;  // coordinates have 11 bits

template <typename Value>
struct EcfRun {
  Value value;
  std::size_t count;
};

/// Calls next() for one run after the other until all events are assigned.
template <typename Next, typename Assign>
void expand_runs(std::vector<EcfEvent>& events, const Next& next, const Assign& assign) {
  for (std::size_t i = 0; i < events.size();) {
    auto run = next();
    if (run.count > events.size() - i) throw Damage("a run of events beyond the end of its chunk");
    for (; run.count > 0; --run.count) assign(events[i++], run.value);
  }
}

/// A byte holds the step of the stamp (high half) and the number of its events (low half). 15 in the low half: the
/// count follows in two bytes. 15 in the high half: the low half is four more bits of a longer step, lowest first.
void expand_stamps(ByteReader& in, std::vector<EcfEvent>& events) {
  constexpr unsigned kEscape = 15;
  auto t = in.number<std::uint64_t>();
  const auto next_run = [&]() -> EcfRun<std::uint64_t> {
    std::uint64_t step = 0;
    for (unsigned shift = 0;; shift += 4) {
      const auto byte = in.number<std::uint8_t>();
      const unsigned high = byte >> 4U, low = byte & 15U;
      if (high == kEscape) {
        if (shift >= 64) throw Damage("a step in time of more than 64 bits");
        step |= std::uint64_t{low} << shift;
        continue;
      }
      t += step + high;
      return {t, low == kEscape ? in.number<std::uint16_t>() : low};
    }
  };
  expand_runs(events, next_run, [](EcfEvent& e, std::uint64_t v) { e.t = static_cast<std::int64_t>(v); });
}

/// Two bytes hold a row and a count of 5 bits; 31: the count follows in two bytes.
void expand_rows(ByteReader& in, std::vector<EcfEvent>& events) {
  const auto next_run = [&in]() -> EcfRun<std::uint16_t> {
    const auto word = in.number<std::uint16_t>();
    const unsigned count = word & 31U;
    return {static_cast<std::uint16_t>(word >> 5U), count == 31U ? in.number<std::uint16_t>() : count};
  };
  expand_runs(events, next_run, [](EcfEvent& e, std::uint16_t y) { e.y = y; });
}

/// Two bytes hold a column, and one bit for an event in each of the next five columns, the nearest in the highest bit.
void expand_columns(ByteReader& in, std::vector<EcfEvent>& events) {
  for (std::size_t i = 0; i < events.size();) {
    const auto word = in.number<std::uint16_t>();
    const unsigned x = word >> 5U;
    events[i++].x = static_cast<std::uint16_t>(x);
    for (unsigned step = 1; step <= 5 && i < events.size(); ++step)
      if ((word >> (5U - step)) & 1U) events[i++].x = static_cast<std::uint16_t>(x + step);
  }
}

/// A byte holds a polarity and a count of 7 bits; 127: the count follows in two bytes.
void expand_polarities(ByteReader& in, std::vector<EcfEvent>& events) {
  const auto next_run = [&in]() -> EcfRun<bool> {
    const auto byte = in.number<std::uint8_t>();
    const unsigned count = byte & 127U;
    return {byte > 127, count == 127U ? in.number<std::uint16_t>() : count};
  };
  expand_runs(events, next_run, [](EcfEvent& e, bool p) { e.p = p ? 1 : 0; });
}

/// Four events in three words, three quarters of a word each. The rest of the first word is the low bits of the second
/// event, the rest of the second word those of the third.
template <typename Word, typename Assign>
void expand_side_by_side(ByteReader& in, std::vector<EcfEvent>& events, const Assign& assign) {
  constexpr unsigned kQuarter = sizeof(Word) * 2;  // [bits]
  const auto low = [](std::uint32_t word, unsigned quarters) { return word & ((1U << quarters * kQuarter) - 1U); };
  const auto high = [](std::uint32_t word, unsigned quarters) {
    return word >> (4 - quarters) * kQuarter << (3 - quarters) * kQuarter;
  };
  for (std::size_t i = 0; i < events.size(); i += 4) {
    const std::uint32_t a = in.number<Word>(), b = in.number<Word>(), c = in.number<Word>();
    const std::array<std::uint32_t, 4> four{high(a, 3), high(b, 2) | low(a, 1), high(c, 1) | low(b, 2), low(c, 3)};
    for (std::size_t k = 0; k < 4 && i + k < events.size(); ++k) assign(events[i + k], four[k]);
  }
}

void assign_column(EcfEvent& e, std::uint32_t bits) {
  e.x = static_cast<std::uint16_t>((bits >> 1U) & kColumnMask);
  e.p = static_cast<std::int16_t>(bits & 1U);
}

void assign_row_and_column(EcfEvent& e, std::uint32_t bits) {
  e.y = static_cast<std::uint16_t>((bits >> 12U) & kColumnMask);
  assign_column(e, bits);
}

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

std::vector<EcfEvent> decode_ecf(ByteSpan packed, std::size_t max_events) {
  ByteReader in(packed);
  const auto head = in.number<std::uint32_t>();
  if (head >> 2U > max_events) throw Damage("more events than a chunk holds");
  std::vector<EcfEvent> events(head >> 2U);
  expand_stamps(in, events);
  if (head & 2U) {
    expand_side_by_side<std::uint32_t>(in, events, assign_row_and_column);
    return events;
  }
  expand_rows(in, events);
  if (head & 1U) {
    expand_side_by_side<std::uint16_t>(in, events, assign_column);
  } else {
    expand_columns(in, events);
    expand_polarities(in, events);
  }
  return events;
}

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
