// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The interface for writing messages to a container: ROS 1 bag or MCAP.
#pragma once

#include <string_view>

#include "edged/io/ros/bag/message_source.hpp"
#include "edged/io/ros/messages/definitions.hpp"

namespace edged {

/// Counterpart of MessageSource. Holds one chunk and the index in memory. An unfinished file is readable like one of a
/// crashed recorder. All members throw InputError if the file cannot be written.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  virtual Wire wire() const = 0;
  /// Adds a topic and returns its number, for write(). type: "pkg/Name".
  virtual std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) = 0;
  /// t: the time of recording.
  virtual void write(std::size_t topic, Timestamp t, std::string_view message) = 0;
  /// Completes the file with its index. Nothing may be written afterwards.
  virtual void finish() = 0;
};

}  // namespace edged
