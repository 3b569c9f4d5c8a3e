// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads an image file of a recording, and holds an entry of a list of images.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/io/bytes.hpp"
#include "edged/io/source_path.hpp"
#include "edged/time.hpp"

namespace edged {

/// Decodes an image file in memory as read_gray_image() does; empty if it is damaged. Throws cv::Exception.
cv::Mat decode_gray(ByteSpan bytes);

/// Reads an image as 8-bit grey: colours by their luminance, the upper 8 of 16 bits (TUM-VI). Empty if the file is no
/// image or damaged. Throws InputError if the file cannot be read.
cv::Mat read_gray_image(const SourcePath& file);

/// One line of a list of images.
struct FrameEntry {
  Timestamp t;
  SourcePath image;
};

}  // namespace edged
