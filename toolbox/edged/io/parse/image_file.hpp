// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads an image file of a recording, and holds an entry of a list of images.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/archive/source_path.hpp"
#include "edged/time.hpp"

namespace edged {

/// Reads an image by decode_gray(); empty if the file is no image or damaged. Throws InputError if it cannot be read.
cv::Mat read_gray_image(const SourcePath& file);

/// One line of a list of images.
struct FrameEntry {
  Timestamp t;
  SourcePath image;
};

}  // namespace edged
