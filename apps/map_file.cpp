// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "map_file.hpp"

#include <fstream>
#include <iterator>

#include "edged/core/check.hpp"

namespace edged {

std::string read_map_bytes(const std::filesystem::path& file) {
  std::error_code ignored;
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file, ignored))
    throw InputError::format("{}: no map that can be read; `edged run RECORDING --save-map FILE` makes one",
                             file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

SavedMap read_map(const std::filesystem::path& file) {
  const std::string bytes = read_map_bytes(file);
  try {
    return saved_map_from_bytes(bytes);
  } catch (const InputError& e) {
    throw InputError::format("{}: {}", file.string(), e.what());
  }
}

void check_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    throw InputError::format("{}: cannot be written: no folder {}", file.string(), folder.string());
}

}  // namespace edged
