// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pictures in memory, by libpng and libjpeg-turbo. imgcodecs of OpenCV would load 140 libraries, which takes as long as
// all else at the start of a program.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/archive/source_path.hpp"
#include "edged/time.hpp"

namespace edged {

/// Decodes PNG, JPEG and binary PGM as 8-bit grey: colours by their luminance, the upper 8 of 16 bits (TUM-VI), no
/// transparency, as it was stored, not as EXIF turns it. Empty if it is none of these, damaged or cut off, or larger
/// than 64 megapixels.
cv::Mat decode_gray(ByteSpan bytes);

/// image: CV_8UC1, CV_16UC1 or CV_8UC3 (blue first). level: of zlib, 1 (fast) to 9 (small). Throws std::bad_alloc.
Bytes encode_png(const cv::Mat& image, int level = 1);
/// image: CV_8UC1 or CV_8UC3 (blue first). quality: 1 to 100.
Bytes encode_jpeg(const cv::Mat& image, int quality);
/// Binary. image: CV_8UC1.
Bytes encode_pgm(const cv::Mat& image);

/// Reads an image by decode_gray(); empty if the file is no image or damaged. Throws InputError if it cannot be read.
cv::Mat read_gray_image(const SourcePath& file);

/// One line of a list of images.
struct FrameEntry {
  Timestamp t;
  SourcePath image;
};

}  // namespace edged
