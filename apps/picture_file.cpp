// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "picture_file.hpp"

#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "edged/core/check.hpp"

namespace edged {

void make_picture_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw InputError::format("{}: cannot make this folder ({}); choose another --out", folder.string(),
                             failed.message());
}

void write_picture(const std::filesystem::path& file, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), image);
  } catch (const cv::Exception&) {
  }
  if (!written) throw InputError::format("{}: cannot be written; choose another --out", file.string());
}

}  // namespace edged
