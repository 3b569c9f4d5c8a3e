// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Output files of a command. A file is complete or absent, and errors name a remedy.
#pragma once

#include <filesystem>
#include <fstream>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

#include "edged/core/whole_file.hpp"

namespace edged {

/// A table that grows: it consists of complete lines, whenever the program ends.
class TableFile {
 public:
  /// Both throw InputError if the file cannot be written.
  TableFile(std::filesystem::path file, const std::string& heading);
  void add(const std::string& line);

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

/// Throws InputError, with the option, if the file cannot be written, or is there and does not begin as its kind does:
/// a recording, say. To be called before a long run whose result goes to the file.
void check_writable(const std::filesystem::path& file, const char* option, std::string_view kind_begins = "");

/// Throws InputError, with the option, if the folder is there and not empty.
void check_empty(const std::filesystem::path& folder, const char* option);

/// Make a folder, and write an image there. Throw InputError, which names --out, if they cannot be written.
void make_picture_folder(const std::filesystem::path& folder);
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace edged
