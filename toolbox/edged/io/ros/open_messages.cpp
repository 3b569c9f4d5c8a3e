// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which container a file is.
#include "edged/io/ros/open_messages.hpp"

#include "edged/core/check.hpp"
#include "edged/io/mcap_format.hpp"
#include "edged/io/ros/bag.hpp"
#include "edged/io/ros/bag_folder.hpp"
#include "edged/io/ros/bag_format.hpp"
#include "edged/io/ros/db3.hpp"
#include "edged/io/ros/mcap.hpp"
#include "edged/io/ros/unpacked_source.hpp"

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

}  // namespace

bool is_bag(ByteSpan head) { return container_of(head) != Container::None; }

bool is_bag_folder(const std::filesystem::path& folder) { return !bag_parts(folder).empty(); }

std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, Repairs* repairs) {
  if (!std::filesystem::is_directory(path)) return open_container(path, repairs);
  std::vector<std::unique_ptr<MessageSource>> parts;
  for (const std::filesystem::path& file : bag_parts(path)) parts.push_back(open_container(file, repairs));
  return std::make_unique<BagFolder>(std::move(parts));
}

}  // namespace edged
