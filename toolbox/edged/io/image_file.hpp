// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Images as files of a recording: reading one, and an entry of a list of them.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/io/source_path.hpp"
#include "edged/time.hpp"

namespace edged {

/// 8 bits of grey: colours by their luminance, of 16 bits the upper 8 (TUM-VI). Empty where the file is no image or
/// damaged. Throws InputError where it cannot be read at all.
cv::Mat read_gray_image(const SourcePath& file);

/// One line of a list of images.
struct FrameEntry {
  Timestamp t;
  SourcePath image;
};

}  // namespace edged
