// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/image_file.hpp"

#include <opencv2/imgcodecs.hpp>

#include "edged/core/check.hpp"

namespace edged {

cv::Mat read_gray_image(const SourcePath& file) try {
  constexpr std::size_t kMostBytes = std::size_t{1} << 28U;
  const Bytes bytes = file.read(kMostBytes);
  return bytes.empty() ? cv::Mat() : cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
} catch (const Damage&) {
  return {};
} catch (const cv::Exception&) {
  return {};
}

}  // namespace edged
