// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/bag/bag_files.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <set>
#include <tuple>

namespace edged {
namespace {

/// Splits "NAME_12.bag" into "NAME_", 12 and ".bag".
struct PartName {
  std::string front, back;
  int number = 0;
};

std::optional<PartName> part_name(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const std::size_t dot = name.find('.', name.rfind('_') + 1), bar = name.rfind('_');
  if (bar == std::string::npos || dot == std::string::npos) return std::nullopt;
  PartName part{name.substr(0, bar + 1), name.substr(dot), 0};
  const char* const end = name.data() + dot;
  const auto [stop, error] = std::from_chars(name.data() + bar + 1, end, part.number);
  if (error != std::errc() || stop != end || part.number < 0) return std::nullopt;
  return part;
}

/// name_2 before name_10, compressed or not.
std::tuple<std::string, int, std::size_t, std::string> order_of_part(const std::filesystem::path& file) {
  const std::string name = (file.extension() == ".zstd" ? file.stem() : file.filename()).string();
  const PartName part = part_name(file).value_or(PartName());
  return {part.front, part.number, name.size(), name};
}

/// The files that a metadata.yaml lists: lines of `- NAME.db3`.
std::vector<std::string> listed_parts(const std::filesystem::path& metadata) {
  std::vector<std::string> names;
  std::ifstream in(metadata);
  for (std::string line; std::getline(in, line);) {
    const std::size_t begin = line.find_first_not_of(" -\"'\t"), dash = line.find('-');
    const std::size_t end = line.find_last_not_of(" \"'\t\r");
    if (begin == std::string::npos || dash >= begin) continue;
    const std::string name = line.substr(begin, end - begin + 1);
    for (const char* ending : {".db3", ".mcap", ".db3.zstd", ".mcap.zstd"})
      if (name.ends_with(ending) && name.find(':') == std::string::npos) names.push_back(name);
  }
  return names;
}

}  // namespace

std::vector<std::filesystem::path> bag_parts(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> parts;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::filesystem::path plain = entry.path();
    if (plain.extension() == ".zstd") {
      plain.replace_extension();
      if (std::filesystem::exists(plain)) continue;  // the recorder was stopped while it compressed
    }
    const auto extension = plain.extension();
    if (entry.is_regular_file() && (extension == ".db3" || extension == ".mcap")) parts.push_back(entry.path());
  }
  std::ranges::sort(parts, {}, order_of_part);
  return parts;
}

std::vector<std::filesystem::path> split_bag_parts(const std::filesystem::path& first) {
  const auto own = part_name(first);
  if (!own || own->back != ".bag") return {first};
  std::vector<std::pair<int, std::filesystem::path>> parts;
  std::error_code ignored;
  const std::filesystem::path folder = first.has_parent_path() ? first.parent_path() : ".";
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const auto other = part_name(entry.path());
    if (other && other->front == own->front && other->back == own->back && entry.is_regular_file(ignored))
      parts.emplace_back(other->number, first.parent_path() / entry.path().filename());
  }
  std::ranges::sort(parts);
  if (parts.size() < 2 || parts.front().first != own->number) return {first};
  std::vector<std::filesystem::path> files;
  for (auto& part : parts) files.push_back(std::move(part.second));
  return files;
}

std::vector<std::string> missing_parts(const std::vector<std::filesystem::path>& parts) {
  std::set<std::string> missing;
  std::set<std::string> there;
  for (const std::filesystem::path& file : parts) {
    there.insert(file.filename().string());
    if (file.extension() == ".zstd") there.insert(file.stem().string());  // metadata.yaml lists either name
  }
  const auto is_there = [&there](const std::string& name) {
    return there.contains(name) || there.contains(std::filesystem::path(name).stem().string());
  };
  const std::vector<std::string> listed = listed_parts(parts.front().parent_path() / "metadata.yaml");
  if (std::ranges::any_of(listed, is_there)) {  // otherwise the files have been renamed
    for (const std::string& name : listed)
      if (!is_there(name)) missing.insert(name);
    return {missing.begin(), missing.end()};
  }
  if (const auto last = part_name(parts.back()); last && parts.size() > 1) {
    std::set<int> numbers;
    for (const std::filesystem::path& file : parts)
      if (const auto part = part_name(file); part && part->front == last->front) numbers.insert(part->number);
    for (int i = 0; numbers.size() == parts.size() && i < last->number; ++i)
      if (!numbers.contains(i)) missing.insert(last->front + std::to_string(i) + last->back);
  }
  return {missing.begin(), missing.end()};
}

}  // namespace edged
