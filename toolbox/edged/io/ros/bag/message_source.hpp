// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The interface for reading the messages of a container: ROS 1 bag, SQLite or MCAP.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/topic_choice.hpp"
#include "edged/time.hpp"

namespace edged {

/// The serialization of a message.
enum class Wire { Ros1, Cdr };

struct Message {
  std::size_t topic = 0;  ///< index of topics()
  ByteSpan data;          ///< valid until the next call
};

/// Messages in file order, which is approximately that of their recording. Damage is skipped and counted. Complete
/// messages before the damage are returned.
class MessageSource {
 public:
  virtual ~MessageSource() = default;
  virtual Wire wire() const = 0;
  virtual const std::vector<Topic>& topics() const = 0;
  /// From the first to the last message, by the clock of the recorder.
  virtual Duration length() const = 0;
  /// Stamp of the first message by the clock of the recorder, if the container states it.
  virtual std::optional<Timestamp> begin_stamp() const { return std::nullopt; }
  virtual std::optional<Message> next() = 0;
  /// The next message of that topic. With an index, the messages before it are not read.
  virtual std::optional<Message> next_of(std::size_t topic);
};

/// Index of the topic of that name and type, which is added if it is new. "pkg/msg/Name" becomes "pkg/Name".
std::size_t topic_index(std::vector<Topic>& topics, std::string_view name, std::string_view type,
                        std::string_view definition = {});

}  // namespace edged
