// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/image_codec.hpp"

#include <png.h>
#include <spdlog/fmt/fmt.h>
#include <turbojpeg.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26U;

bool is_size_allowed(std::uint64_t width, std::uint64_t height) {
  return width > 0 && height > 0 && width <= kMostPixels && height <= kMostPixels / width;
}

// libpng leaves a function by longjmp, so nothing with a destructor may live in one that calls it.

[[noreturn]] void on_png_error(png_structp png, png_const_charp /*message*/) { png_longjmp(png, 1); }
void on_png_warning(png_structp /*png*/, png_const_charp /*message*/) {}

void read_png_bytes(png_structp png, png_bytep to, std::size_t size) {
  auto& rest = *static_cast<ByteSpan*>(png_get_io_ptr(png));
  if (size > rest.size()) png_error(png, "cut off");
  std::memcpy(to, rest.data(), size);
  rest = rest.subspan(size);
}

/// To one grey byte a pixel, whatever the file has.
void convert_to_gray(png_structp png, png_infop info) {
  const int colour = png_get_color_type(png, info);
  if (png_get_bit_depth(png, info) == 16) png_set_strip_16(png);
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (colour == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(png);
  if ((colour & PNG_COLOR_MASK_COLOR) != 0) png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
  png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

/// Fills image; false if the file is damaged.
bool read_png(ByteSpan bytes, cv::Mat& image, std::vector<png_bytep>& rows) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, on_png_error, on_png_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  constexpr png_uint_32 kMostChunks = 16;  // texts and the like, each of up to 8 MB in memory
  png_set_chunk_cache_max(png, kMostChunks);
  png_set_read_fn(png, &bytes, read_png_bytes);
  png_read_info(png, info);
  const png_uint_32 width = png_get_image_width(png, info), height = png_get_image_height(png, info);
  if (!is_size_allowed(width, height)) png_error(png, "too large");
  convert_to_gray(png, info);
  if (png_get_rowbytes(png, info) != width) png_error(png, "not grey");
  image.create(static_cast<int>(height), static_cast<int>(width), CV_8UC1);
  rows.resize(height);
  for (png_uint_32 y = 0; y < height; ++y) rows[y] = image.ptr(static_cast<int>(y));
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

void write_png_bytes(png_structp png, png_bytep from, std::size_t size) {
  auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), from, from + size);
}

bool write_png(const cv::Mat& image, int level, Bytes& bytes) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_png_error, on_png_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &bytes, write_png_bytes, nullptr);
  if (level <= 1) {
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_strategy(png, Z_RLE);
  }
  png_set_compression_level(png, level);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
               image.depth() == CV_16U ? 16 : 8, image.channels() == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_set_bgr(png);
  if (image.depth() == CV_16U && std::endian::native == std::endian::little) png_set_swap(png);
  for (int y = 0; y < image.rows; ++y) png_write_row(png, image.ptr(y));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

struct JpegEnd {
  void operator()(void* jpeg) const { tjDestroy(jpeg); }
};
using Jpeg = std::unique_ptr<void, JpegEnd>;

cv::Mat read_jpeg(ByteSpan bytes) {
  const Jpeg jpeg(tjInitDecompress());
  const auto size = static_cast<unsigned long>(bytes.size());
  int width = 0, height = 0, sampling = 0, colours = 0;
  if (!jpeg || tjDecompressHeader3(jpeg.get(), bytes.data(), size, &width, &height, &sampling, &colours) != 0)
    return {};
  if (width <= 0 || height <= 0 || !is_size_allowed(static_cast<unsigned>(width), static_cast<unsigned>(height)))
    return {};
  cv::Mat image(height, width, CV_8UC1);
  if (tjDecompress2(jpeg.get(), bytes.data(), size, image.ptr(), width, 0, height, TJPF_GRAY, 0) != 0) {
    // Cameras write bytes between segments that the library warns of; what ends too early has no lower part.
    const std::string_view problem = tjGetErrorStr2(jpeg.get());
    if (tjGetErrorCode(jpeg.get()) != TJERR_WARNING || problem.find("remature end") != problem.npos) return {};
  }
  return image;
}

/// The next number of the heading of a PGM, behind blanks and comments.
std::optional<unsigned> next_number(std::string_view& text) {
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    if (!text.starts_with('#')) break;
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

cv::Mat read_pgm(ByteSpan bytes) {
  std::string_view text = as_text(bytes).substr(2);
  const std::optional<unsigned> width = next_number(text), height = next_number(text), white = next_number(text);
  if (!width || !height || !white || !is_size_allowed(*width, *height) || *white == 0 || *white > 65535) return {};
  const std::size_t sample = *white > 255 ? 2 : 1, pixels = std::size_t{*width} * *height;
  if (text.size() < 1 + sample * pixels) return {};
  const ByteSpan data = as_bytes(text.substr(1));
  cv::Mat image(static_cast<int>(*height), static_cast<int>(*width), CV_8UC1);
  for (std::size_t i = 0; i < pixels; ++i) {
    const unsigned value = sample == 1 ? data[i] : data[2 * i] << 8U | data[2 * i + 1];
    image.data[i] = static_cast<std::uint8_t>(std::min(255U, value * 256 / (*white + 1)));
  }
  return image;
}

}  // namespace

cv::Mat decode_gray(ByteSpan bytes) {
  const std::string_view file = as_text(bytes);
  if (file.starts_with("\xff\xd8\xff")) return read_jpeg(bytes);
  if (file.starts_with("P5")) return read_pgm(bytes);
  if (!file.starts_with("\x89PNG\r\n\x1a\n")) return {};
  cv::Mat image;
  std::vector<png_bytep> rows;
  return read_png(bytes, image, rows) ? image : cv::Mat();
}

Bytes encode_png(const cv::Mat& image, int level) {
  EDGED_CHECK(image.type() == CV_8UC1 || image.type() == CV_16UC1 || image.type() == CV_8UC3, "such an image");
  Bytes bytes;
  if (!write_png(image, level, bytes)) throw std::bad_alloc();
  return bytes;
}

Bytes encode_jpeg(const cv::Mat& image, int quality) {
  EDGED_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3, "such an image");
  const bool colour = image.channels() == 3;
  const Jpeg jpeg(tjInitCompress());
  const int sampling = colour ? TJSAMP_420 : TJSAMP_GRAY;
  unsigned long size = tjBufSize(image.cols, image.rows, sampling);
  Bytes bytes(size);
  unsigned char* to = bytes.data();
  if (!jpeg || tjCompress2(jpeg.get(), image.ptr(), image.cols, static_cast<int>(image.step[0]), image.rows,
                           colour ? TJPF_BGR : TJPF_GRAY, &to, &size, sampling, quality, TJFLAG_NOREALLOC) != 0)
    throw std::bad_alloc();
  bytes.resize(size);
  return bytes;
}

Bytes encode_pgm(const cv::Mat& image) {
  EDGED_CHECK(image.type() == CV_8UC1, "such an image");
  const std::string heading = fmt::format("P5\n{} {}\n255\n", image.cols, image.rows);
  Bytes bytes(heading.begin(), heading.end());
  for (int y = 0; y < image.rows; ++y) bytes.insert(bytes.end(), image.ptr(y), image.ptr(y) + image.cols);
  return bytes;
}

cv::Mat read_gray_image(const SourcePath& file) try {
  constexpr std::size_t kMostBytes = std::size_t{1} << 28U;
  return decode_gray(file.read(kMostBytes));
} catch (const Damage&) {
  return {};
}

}  // namespace edged
