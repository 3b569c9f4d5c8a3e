// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/bag/mcap_sink.hpp"

namespace edged {

std::size_t McapSink::add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) {
  std::string long_type(type);
  long_type.insert(long_type.find('/'), "/msg");
  return file_.add_topic({name, "cdr", long_type, "ros2msg", definition.text});
}

}  // namespace edged
