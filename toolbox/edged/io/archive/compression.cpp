// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Decompression with three libraries in one loop, which stops at the end of the data, at damage or at the limit.
#include "edged/io/archive/compression.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

namespace edged {
namespace {

enum class Step { More, End, Failed };

/// Extends the output until `step(output, consumed, produced)` returns that it is complete. A step without progress
/// means that the data are cut.
template <typename StepFunction>
Decompressed unpack(ByteSpan packed, std::size_t max_bytes, const StepFunction& step) {
  Decompressed out;
  std::size_t filled = 0;
  while (true) {
    if (filled == out.bytes.size()) {
      if (filled > max_bytes) break;
      out.bytes.resize(std::min(max_bytes + 1, std::max<std::size_t>({2 * filled, 4 * packed.size(), 4096})));
    }
    std::size_t consumed = 0, produced = 0;
    const Step result = step(packed, std::span(out.bytes).subspan(filled), consumed, produced);
    packed = packed.subspan(consumed);
    filled += produced;
    out.whole = result == Step::End && packed.empty();
    if (result == Step::Failed || out.whole || (consumed == 0 && produced == 0)) break;
  }
  out.bytes.resize(filled);
  return out;
}

Decompressed unpack_lz4(ByteSpan packed, std::size_t max_bytes) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                   &LZ4F_freeDecompressionContext);
  return unpack(
      packed, max_bytes, [&](ByteSpan in, std::span<std::uint8_t> to, std::size_t& consumed, std::size_t& produced) {
        consumed = in.size(), produced = to.size();
        const std::size_t hint = LZ4F_decompress(context, to.data(), &produced, in.data(), &consumed, nullptr);
        if (LZ4F_isError(hint)) {
          consumed = produced = 0;
          return Step::Failed;
        }
        return hint == 0 ? Step::End : Step::More;
      });
}

Decompressed unpack_zstd(ByteSpan packed, std::size_t max_bytes) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  return unpack(packed, max_bytes,
                [&](ByteSpan in, std::span<std::uint8_t> to, std::size_t& consumed, std::size_t& produced) {
                  ZSTD_inBuffer source{in.data(), in.size(), 0};
                  ZSTD_outBuffer target{to.data(), to.size(), 0};
                  const std::size_t hint = ZSTD_decompressStream(context.get(), &target, &source);
                  consumed = source.pos, produced = target.pos;
                  if (ZSTD_isError(hint)) return Step::Failed;
                  return hint == 0 ? Step::End : Step::More;
                });
}

Decompressed unpack_bz2(ByteSpan packed, std::size_t max_bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> owner(&stream, &BZ2_bzDecompressEnd);
  constexpr std::size_t kMost = 1U << 30U;  // the counters of the library have 32 bits
  return unpack(packed, max_bytes,
                [&](ByteSpan in, std::span<std::uint8_t> to, std::size_t& consumed, std::size_t& produced) {
                  const auto in_size = static_cast<unsigned>(std::min(in.size(), kMost));
                  const auto to_size = static_cast<unsigned>(std::min(to.size(), kMost));
                  // The library wants a mutable pointer, but only reads.
                  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
                  stream.next_out = reinterpret_cast<char*>(to.data());
                  stream.avail_in = in_size, stream.avail_out = to_size;
                  const int result = BZ2_bzDecompress(&stream);
                  consumed = in_size - stream.avail_in, produced = to_size - stream.avail_out;
                  if (result != BZ_OK && result != BZ_STREAM_END) return Step::Failed;
                  return result == BZ_STREAM_END ? Step::End : Step::More;
                });
}

std::string pack_lz4(std::string_view bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size = LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size)) throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

std::string pack_zstd(std::string_view bytes) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size)) throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

}  // namespace

Decompressed decompress(std::string_view method, ByteSpan packed, std::size_t max_bytes) {
  if (method.empty() || method == "none") return {Bytes(packed.begin(), packed.end()), true};
  if (method == "lz4") return unpack_lz4(packed, max_bytes);
  if (method == "zstd") return unpack_zstd(packed, max_bytes);
  if (method == "bz2") return unpack_bz2(packed, max_bytes);
  throw Damage("compression `" + std::string(method) + "` is not known");
}

bool decompress_zstd_file(const std::filesystem::path& packed, const std::filesystem::path& unpacked) {
  constexpr std::size_t kPiece = 1U << 20U;
  constexpr std::uint64_t kMostRatio = 1000;  // no recording is compressed further
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  BinaryFile from(packed);
  OutputFile to(unpacked);
  Bytes piece(kPiece);
  std::size_t hint = 1;  // zero at the end of a frame
  for (std::uint64_t at = 0; at < from.size() && !ZSTD_isError(hint);) {
    if (to.size() / kMostRatio > from.size()) return false;
    const Bytes in = from.read(at, kPiece);
    if (in.empty()) break;
    at += in.size();
    ZSTD_inBuffer source{in.data(), in.size(), 0};
    ZSTD_outBuffer target{piece.data(), piece.size(), 0};
    do {
      target.pos = 0;
      hint = ZSTD_decompressStream(context.get(), &target, &source);
      to.write(as_text(ByteSpan(piece).first(target.pos)));
    } while (!ZSTD_isError(hint) && (source.pos < source.size || target.pos == target.size));
  }
  to.flush();
  return hint == 0;
}

std::string compress(std::string_view method, std::string_view bytes) {
  if (method.empty() || method == "none") return std::string(bytes);
  if (method == "lz4") return pack_lz4(bytes);
  if (method == "zstd") return pack_zstd(bytes);
  throw Damage("compression `" + std::string(method) + "` is not known");
}

}  // namespace edged
