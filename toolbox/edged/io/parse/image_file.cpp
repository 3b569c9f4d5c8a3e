// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/image_file.hpp"

#include "edged/core/check.hpp"
#include "edged/io/parse/image_codec.hpp"

namespace edged {

cv::Mat read_gray_image(const SourcePath& file) try {
  constexpr std::size_t kMostBytes = std::size_t{1} << 28U;
  return decode_gray(file.read(kMostBytes));
} catch (const Damage&) {
  return {};
}

}  // namespace edged
