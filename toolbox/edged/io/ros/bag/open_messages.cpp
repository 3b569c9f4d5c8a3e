// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects the container of a file.
#include "edged/io/ros/bag/open_messages.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "edged/core/check.hpp"
#include "edged/io/ros/bag/bag.hpp"
#include "edged/io/ros/bag/bag_folder.hpp"
#include "edged/io/ros/bag/bag_format.hpp"
#include "edged/io/ros/bag/db3.hpp"
#include "edged/io/ros/bag/mcap.hpp"
#include "edged/io/ros/bag/mcap_format.hpp"
#include "edged/io/ros/bag/unpacked_source.hpp"

namespace edged {
namespace {

enum class Container { None, Bag, Mcap, Db3, Zstd };

Container container_of(ByteSpan head) {
  const std::string_view magic = as_text(head);
  if (magic.starts_with(kBagMagic)) return Container::Bag;
  if (magic.starts_with(kMcapMagic)) return Container::Mcap;
  if (magic.starts_with("SQLite format 3")) return Container::Db3;
  if (magic.starts_with(kZstdMagic)) return Container::Zstd;
  return Container::None;
}

std::unique_ptr<MessageSource> open_container(const std::filesystem::path& file, Repairs* repairs) {
  constexpr std::size_t kContainerHeadBytes = 16;
  const auto unpacked = [&](std::unique_ptr<MessageSource> source) {
    return std::make_unique<UnpackedSource>(std::move(source), file.string(), repairs);
  };
  switch (container_of(BinaryFile(file).read(0, kContainerHeadBytes))) {
    case Container::Bag:
      return std::make_unique<Bag>(file, repairs);
    case Container::Mcap:
      return unpacked(std::make_unique<Mcap>(file, repairs));
    case Container::Db3:
      return unpacked(std::make_unique<Db3>(file, repairs));
    case Container::Zstd:
      return open_packed_messages(
          file, [repairs](const std::filesystem::path& plain) { return open_container(plain, repairs); }, repairs);
    case Container::None:
      break;
  }
  throw InputError::format("{}: no ROS bag, or its beginning is damaged", file.string());
}

/// Files that have only the names of parts were recorded at other times.
bool follows(const MessageSource& part, const MessageSource& before) {
  constexpr Duration kOverlap = std::chrono::seconds(5), kGap = std::chrono::seconds(10);
  if (!part.begin_stamp() || !before.begin_stamp()) return true;
  const Duration gap = *part.begin_stamp() - (*before.begin_stamp() + before.length());
  return gap > -kOverlap && gap < kGap;
}

}  // namespace

bool is_bag(ByteSpan head) { return container_of(head) != Container::None; }

bool is_bag_folder(const std::filesystem::path& folder) { return !bag_parts(folder).empty(); }

std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, Repairs* repairs) {
  const bool folder = std::filesystem::is_directory(path);
  const std::vector<std::filesystem::path> files = folder ? bag_parts(path) : split_bag_parts(path);
  if (!folder && files.size() == 1) return open_container(path, repairs);
  std::vector<std::unique_ptr<MessageSource>> parts;
  const std::vector<std::string> missing = missing_parts(files);
  for (const std::filesystem::path& file : files) {
    parts.push_back(open_container(file, repairs));
    if (folder || parts.size() == 1 || !missing.empty() || follows(*parts.back(), *parts[parts.size() - 2])) continue;
    if (repairs)
      spdlog::warn(
          fmt::format("{}: does not follow the part before it: {} is read alone", file.string(), path.string()));
    return open_container(path, repairs);
  }
  if (!missing.empty() && repairs)
    repairs->add("bag: part missing",
                 fmt::format("{}: lacks {}; the others are read", path.string(), fmt::join(missing, ", ")));
  return std::make_unique<BagFolder>(std::move(parts));
}

}  // namespace edged
