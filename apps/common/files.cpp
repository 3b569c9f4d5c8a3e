// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/files.hpp"

#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "edged/core/check.hpp"

namespace edged {

std::filesystem::path part_of(std::filesystem::path file) { return file += ".part"; }

std::ofstream open_for_writing(const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw InputError::format("{}: cannot be written; check the folder given to --out", file.string());
  return out;
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = part_of(file);
  std::ofstream out = open_for_writing(part);
  out << text;
  if (!out.flush()) throw InputError::format("{}: cannot be written; is the disk full?", file.string());
  std::filesystem::rename(part, file);
}

void check_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    throw InputError::format("{}: cannot be written: no folder {}", file.string(), folder.string());
}

void make_picture_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw InputError::format("{}: cannot make this folder ({}); choose another --out", folder.string(),
                             failed.message());
}

void write_picture(const std::filesystem::path& file, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(file.extension().string(), image, bytes);
  write_file(file, std::string(bytes.begin(), bytes.end()));
}

}  // namespace edged
