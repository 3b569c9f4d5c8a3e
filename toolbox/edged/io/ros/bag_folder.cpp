// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Parts of a bag, one after the other.
#include "edged/io/ros/bag_folder.hpp"

#include <algorithm>
#include <numeric>

namespace edged {

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
  // name_2 before name_10.
  std::ranges::sort(parts, {}, [](const std::filesystem::path& p) { return std::pair(p.string().size(), p.string()); });
  return parts;
}

BagFolder::BagFolder(std::vector<std::unique_ptr<MessageSource>> parts) {
  for (std::unique_ptr<MessageSource>& source : parts) {
    Part part{std::move(source), {}};
    for (const Topic& topic : part.source->topics()) {
      part.topics.push_back(topic_index(topics_, topic.name, topic.type, topic.definition));
      topics_[part.topics.back()].count += topic.count;
    }
    parts_.push_back(std::move(part));
  }
}

Duration BagFolder::length() const {
  return std::accumulate(parts_.begin(), parts_.end(), Duration(0),
                         [](Duration sum, const Part& part) { return sum + part.source->length(); });
}

std::optional<Message> BagFolder::next() {
  for (; current_ < parts_.size(); ++current_) {
    const Part& part = parts_[current_];
    while (const auto message = part.source->next())
      if (message->topic < part.topics.size())  // the index of a damaged file may lack topics that turn up later
        return Message{part.topics[message->topic], message->data};
  }
  return std::nullopt;
}

std::optional<Message> BagFolder::next_of(std::size_t topic) {
  for (; current_ < parts_.size(); ++current_) {
    const Part& part = parts_[current_];
    const auto own = std::ranges::find(part.topics, topic);
    if (own == part.topics.end()) continue;
    if (const auto message = part.source->next_of(static_cast<std::size_t>(own - part.topics.begin())))
      return Message{topic, message->data};
  }
  return std::nullopt;
}

}  // namespace edged
