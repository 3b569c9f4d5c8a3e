// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/image_codec.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "edged/core/test_data.hpp"

namespace edged {
namespace {

cv::Mat gray_waves() {
  cv::Mat image(60, 91, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(127 + 80 * std::sin(0.2 * x) * std::cos(0.1 * y));
  return image;
}

double most_different(const cv::Mat& one, const cv::Mat& other) { return cv::norm(one, other, cv::NORM_INF); }

TEST(ImageCodec, ReturnsGreyImagesAsTheyWere) {
  const cv::Mat image = gray_waves();
  for (const int level : {1, 9}) EXPECT_EQ(most_different(decode_gray(encode_png(image, level)), image), 0.0);
  EXPECT_EQ(most_different(decode_gray(encode_pgm(image)), image), 0.0);
  EXPECT_LE(most_different(decode_gray(encode_jpeg(image, 95)), image), 5.0);
  EXPECT_EQ(most_different(decode_gray(encode_png(image.colRange(3, 40))), image.colRange(3, 40)), 0.0);
}

TEST(ImageCodec, TakesTheLuminanceOfColours) {
  cv::Mat colour, gray;
  cv::applyColorMap(gray_waves(), colour, cv::COLORMAP_JET);
  cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
  EXPECT_LE(most_different(decode_gray(encode_png(colour)), gray), 1.0);
  cv::GaussianBlur(colour, colour, {}, 3.0);
  cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
  EXPECT_LE(most_different(decode_gray(encode_jpeg(colour, 98)), gray), 6.0);
}

TEST(ImageCodec, TakesTheUpperBitsOfDeepImages) {
  cv::Mat deep;
  gray_waves().convertTo(deep, CV_16U, 256.0, 77.0);
  EXPECT_EQ(most_different(decode_gray(encode_png(deep)), gray_waves()), 0.0);
  const std::string twelve_bits = std::string("P5 # of a camera\n2 1\n4095\n") + '\x0f' + '\xff' + '\x08' + '\0';
  const cv::Mat read = decode_gray(as_bytes(twelve_bits));
  ASSERT_EQ(read.size(), cv::Size(2, 1));
  EXPECT_EQ(read.at<std::uint8_t>(0, 0), 255);
  EXPECT_EQ(read.at<std::uint8_t>(0, 1), 128);
}

TEST(ImageCodec, TextsInAPictureTakeLittleMemory) {
  Bytes png = encode_png(gray_waves());
  const auto big_endian = [](std::uint32_t value) {
    return Bytes{static_cast<std::uint8_t>(value >> 24U), static_cast<std::uint8_t>(value >> 16U),
                 static_cast<std::uint8_t>(value >> 8U), static_cast<std::uint8_t>(value)};
  };
  Bytes chunk = {'t', 'E', 'X', 't', 'k', 0};
  chunk.resize(1 << 20, 'x');
  Bytes texts;
  for (int i = 0; i < 100; ++i)
    for (const Bytes& part : {big_endian(static_cast<std::uint32_t>(chunk.size() - 4)), chunk,
                              big_endian(static_cast<std::uint32_t>(crc32_z(0, chunk.data(), chunk.size())))})
      texts.insert(texts.end(), part.begin(), part.end());
  constexpr std::size_t kHeader = 8 + 25;
  png.insert(png.begin() + kHeader, texts.begin(), texts.end());
  EXPECT_EQ(most_different(decode_gray(png), gray_waves()), 0.0);
}

/// An independent reader and writer.
TEST(ImageCodec, AgreesWithOpenCv) {
  cv::Mat colour, transparent, deep, deep_colour;
  cv::applyColorMap(gray_waves(), colour, cv::COLORMAP_JET);
  cv::cvtColor(colour, transparent, cv::COLOR_BGR2BGRA);
  gray_waves().convertTo(deep, CV_16U, 250.0, 3.0);
  colour.convertTo(deep_colour, CV_16U, 250.0, 3.0);
  Bytes bytes;
  for (const char* extension : {".png", ".jpg", ".pgm"}) {
    for (const cv::Mat& image : {gray_waves(), colour, transparent, deep, deep_colour}) {
      const std::string what = std::string(extension) + ", type " + std::to_string(image.type());
      if (extension != std::string(".png") && (image.depth() != CV_8U || image.channels() == 4)) continue;
      if (extension == std::string(".pgm") && image.channels() != 1) continue;
      ASSERT_TRUE(cv::imencode(extension, image, bytes)) << what;
      EXPECT_EQ(most_different(decode_gray(bytes), cv::imdecode(bytes, cv::IMREAD_GRAYSCALE)), 0.0) << what;
    }
  }
  for (const cv::Mat& image : {gray_waves(), colour, deep})
    EXPECT_EQ(most_different(cv::imdecode(encode_png(image), cv::IMREAD_UNCHANGED), image), 0.0) << image.type();
  EXPECT_EQ(most_different(cv::imdecode(encode_pgm(gray_waves()), cv::IMREAD_UNCHANGED), gray_waves()), 0.0);
  EXPECT_LE(most_different(cv::imdecode(encode_jpeg(gray_waves(), 95), cv::IMREAD_UNCHANGED), gray_waves()), 5.0);
}

TEST(ImageCodec, ReadsAFileOfACamera) {
  const SourcePath file(data_folder() / "euroc_mh01/mav0/cam0/data/1403636584763555584.png");
  if (!file.is_file()) GTEST_SKIP() << file.string() << " is not there";
  const cv::Mat image = read_gray_image(file);
  EXPECT_EQ(image.size(), cv::Size(752, 480));
  EXPECT_NEAR(cv::mean(image)[0], 100.0, 60.0);
}

TEST(ImageCodec, RefusesWhatIsCutOffOrDamaged) {
  for (const Bytes& whole : {encode_png(gray_waves()), encode_jpeg(gray_waves(), 90), encode_pgm(gray_waves())}) {
    ASSERT_FALSE(decode_gray(whole).empty());
    for (std::size_t size = 0; size + 2 < whole.size(); size += 1 + whole.size() / 97)
      EXPECT_TRUE(decode_gray(ByteSpan(whole).first(size)).empty()) << size << " of " << whole.size();
  }
  const Bytes png = encode_png(gray_waves());
  for (std::size_t i = 0; i < png.size(); i += 1 + png.size() / 97) {
    Bytes damaged = png;
    damaged[i] ^= 0x10U;
    EXPECT_TRUE(decode_gray(damaged).empty()) << i;
  }
  EXPECT_TRUE(decode_gray({}).empty());
  EXPECT_TRUE(decode_gray(as_bytes("P5 60000 60000 255 ")).empty());
  EXPECT_TRUE(decode_gray(as_bytes("P5 -1 2 255 ")).empty());
  EXPECT_TRUE(decode_gray(as_bytes("GIF89a, which no camera writes")).empty());
}

}  // namespace
}  // namespace edged
