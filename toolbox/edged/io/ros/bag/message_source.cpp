// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/bag/message_source.hpp"

#include <algorithm>

namespace edged {

std::optional<Message> MessageSource::next_of(std::size_t topic) {
  std::optional<Message> message = next();
  while (message && message->topic != topic) message = next();
  return message;
}

std::size_t topic_index(std::vector<Topic>& topics, std::string_view name, std::string_view type,
                        std::string_view definition) {
  std::string short_type(type);
  if (const std::size_t at = short_type.find("/msg/"); at != std::string::npos) short_type.erase(at, 4);
  const auto found =
      std::ranges::find_if(topics, [&](const Topic& topic) { return topic.name == name && topic.type == short_type; });
  if (found != topics.end()) return static_cast<std::size_t>(found - topics.begin());
  topics.push_back({std::string(name), short_type, std::string(definition), 0});
  return topics.size() - 1;
}

}  // namespace edged
