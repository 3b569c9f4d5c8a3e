// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a picture: PNG, with valid checksums, JPEG or PGM.
#include "edged/io/parse/image_codec.hpp"
#include "fuzz_support.hpp"

namespace {

/// Behind each part of a PNG, as far as parts follow each other.
void mend_checksums(std::string& file) {
  constexpr std::size_t kMagic = 8, kFrame = 12;  // bytes of a part beside its data: length, name, checksum
  for (std::size_t at = kMagic; at + kFrame <= file.size();) {
    std::uint32_t bytes = 0;
    std::memcpy(&bytes, file.data() + at, sizeof bytes);
    bytes = __builtin_bswap32(bytes);
    if (bytes > file.size() - at - kFrame) return;
    file.replace(at + 8 + bytes, 4, edged::big_endian(edged::crc_of(std::string_view(file).substr(at + 4, 4 + bytes))));
    at += kFrame + bytes;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(reinterpret_cast<const char*>(data), size);
  mend_checksums(bytes);
  const cv::Mat image = edged::decode_gray(edged::as_bytes(bytes));
  if (!image.empty() && image.type() != CV_8UC1) std::abort();
  return 0;
}
