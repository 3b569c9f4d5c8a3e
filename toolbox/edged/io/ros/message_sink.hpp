// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where messages are written, whatever the container: ROS 1 bag or MCAP.
#pragma once

#include <string_view>

#include "edged/io/ros/definitions.hpp"
#include "edged/io/ros/message_source.hpp"

namespace edged {

/// Counterpart of MessageSource. Holds one chunk and the index in memory. What has been written of a file that is never
/// finished can be read like the recording of a recorder that crashed. All throw InputError when the file cannot be
/// written.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  virtual Wire wire() const = 0;
  /// Number of a new topic, by which write() knows it. type: "pkg/Name".
  virtual std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) = 0;
  /// t: when it was recorded.
  virtual void write(std::size_t topic, Timestamp t, std::string_view message) = 0;
  /// Completes the file with its index; nothing may be written any more.
  virtual void finish() = 0;
};

}  // namespace edged
