// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/image_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "edged/core/check.hpp"

namespace edged {
namespace {

std::uint32_t big_endian(ByteSpan four) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : four.first(4)) value = value << 8U | byte;
  return value;
}

/// Whether libpng will read it: it prints what it does not like. Chunks of the image must be complete, with their sums.
bool is_broken_png(ByteSpan bytes) {
  constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::size_t kFrame = 12;  // length, type, sum
  if (bytes.size() < kSignature.size() || !std::ranges::equal(bytes.first(8), kSignature)) return false;
  for (bytes = bytes.subspan(8); bytes.size() >= kFrame;) {
    const std::size_t length = big_endian(bytes);
    if (length > bytes.size() - kFrame) return true;
    const bool critical = bytes[4] < 'a';
    const ByteSpan summed = bytes.subspan(4, 4 + length);
    if (critical && crc32(0, summed.data(), static_cast<uInt>(summed.size())) != big_endian(bytes.subspan(8 + length)))
      return true;
    if (std::ranges::equal(summed.first(4), std::string_view("IEND"))) return false;
    bytes = bytes.subspan(kFrame + length);
  }
  return true;
}

}  // namespace

cv::Mat decode_gray(ByteSpan bytes) {
  if (bytes.empty() || is_broken_png(bytes)) return {};
  const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
  return cv::imdecode(raw, cv::IMREAD_GRAYSCALE);
}

cv::Mat read_gray_image(const SourcePath& file) try {
  constexpr std::size_t kMostBytes = std::size_t{1} << 28U;
  return decode_gray(file.read(kMostBytes));
} catch (const Damage&) {
  return {};
} catch (const cv::Exception&) {
  return {};
}

}  // namespace edged
