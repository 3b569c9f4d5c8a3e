// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/resources.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>

namespace edged {
namespace fs = std::filesystem;
namespace {

/// The folder of the shared library that this code is in, such as a module of Python; "" if it is not known.
fs::path library_folder() {
  Dl_info info;
  const void* here = reinterpret_cast<const void*>(&library_folder);
  return dladdr(here, &info) != 0 && info.dli_fname ? fs::path(info.dli_fname).parent_path() : fs::path();
}

}  // namespace

std::vector<fs::path> resource_folders(std::string_view kind) {
  std::string variable = "EDGED_";
  for (const char c : kind) variable += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::vector<fs::path> places;
  if (const char* own = std::getenv(variable.c_str())) places.emplace_back(own);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) places.push_back(program.parent_path().parent_path() / "share" / "edged" / kind);
  places.push_back(library_folder() / "share" / "edged" / kind);
  places.push_back(fs::path(EDGED_INSTALLED_RESOURCES) / kind);
  std::vector<fs::path> folders;
  for (const fs::path& place : places) {
    const fs::path folder = fs::canonical(place, error);
    if (!error && std::ranges::find(folders, folder) == folders.end()) folders.push_back(folder);
  }
  return folders;
}

std::vector<fs::path> resources(std::string_view kind, std::string_view extension) {
  std::map<fs::path, fs::path> by_name;
  std::error_code error;
  for (const fs::path& folder : resource_folders(kind)) {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == extension) by_name.try_emplace(entry.path().stem(), entry.path());
    }
  }
  std::vector<fs::path> files;
  for (const auto& [name, file] : by_name) files.push_back(file);
  return files;
}

std::optional<fs::path> find_resource(std::string_view kind, const std::string& name, std::string_view extension) {
  for (const fs::path& folder : resource_folders(kind)) {
    if (const fs::path file = folder / (name + std::string(extension)); fs::exists(file)) return file;
  }
  return std::nullopt;
}

}  // namespace edged
