// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which container a file is.
#include "edged/io/ros/message_source.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/ros/bag.hpp"
#include "edged/io/ros/bag_folder.hpp"
#include "edged/io/ros/bag_format.hpp"
#include "edged/io/ros/db3.hpp"
#include "edged/io/ros/mcap.hpp"
#include "edged/io/ros/mcap_format.hpp"

namespace edged {

namespace {

enum class Container { None, Bag, Mcap, Db3, Folder };

Container container_of(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) return bag_parts(path).empty() ? Container::None : Container::Folder;
  if (!std::filesystem::is_regular_file(path)) return Container::None;
  const Bytes head = BinaryFile(path).read(0, 16);
  const std::string_view magic = as_text(head);
  if (magic.starts_with(kBagMagic)) return Container::Bag;
  if (magic.starts_with(kMcapMagic)) return Container::Mcap;
  if (magic.starts_with("SQLite format 3")) return Container::Db3;
  return Container::None;
}

}  // namespace

bool is_bag(const std::filesystem::path& path) { return container_of(path) != Container::None; }

std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, Repairs* repairs) {
  switch (container_of(path)) {
    case Container::Bag:
      return std::make_unique<Bag>(path, repairs);
    case Container::Mcap:
      return std::make_unique<Mcap>(path, repairs);
    case Container::Db3:
      return std::make_unique<Db3>(path, repairs);
    case Container::Folder:
      return std::make_unique<BagFolder>(bag_parts(path), repairs);
    case Container::None:
      break;
  }
  throw InputError::format("{}: no ROS bag, or its beginning is damaged", path.string());
}

std::size_t topic_index(std::vector<Topic>& topics, std::string_view name, std::string_view type) {
  std::string short_type(type);
  if (const std::size_t at = short_type.find("/msg/"); at != std::string::npos) short_type.erase(at, 4);
  const auto found =
      std::ranges::find_if(topics, [&](const Topic& topic) { return topic.name == name && topic.type == short_type; });
  if (found != topics.end()) return static_cast<std::size_t>(found - topics.begin());
  topics.push_back({std::string(name), short_type, 0});
  return topics.size() - 1;
}

}  // namespace edged
