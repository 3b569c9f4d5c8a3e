// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The messages of a bag, whatever its container: ROS 1 bag, SQLite or MCAP.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/io/bytes.hpp"
#include "edged/io/topic_choice.hpp"
#include "edged/time.hpp"

namespace edged {

/// How numbers and texts of a message are laid out.
enum class Wire { Ros1, Cdr };

struct Message {
  std::size_t topic = 0;  ///< index of topics()
  ByteSpan data;          ///< valid until the next call
};

/// Messages in file order, which is about the order of their recording. Damage is passed over and counted; what is
/// whole before it is given.
class MessageSource {
 public:
  virtual ~MessageSource() = default;
  virtual Wire wire() const = 0;
  virtual const std::vector<Topic>& topics() const = 0;
  /// From the first to the last message, by the recorder's clock.
  virtual Duration length() const = 0;
  /// Of the first message, by the recorder's clock, where the container tells it.
  virtual std::optional<Timestamp> begin_stamp() const { return std::nullopt; }
  virtual std::optional<Message> next() = 0;
  /// The next of that topic alone. What lies before it is not read, as far as an index tells that.
  virtual std::optional<Message> next_of(std::size_t topic);
};

/// Index of the topic of that name and type, which is added where it is new. "pkg/msg/Name" becomes "pkg/Name".
std::size_t topic_index(std::vector<Topic>& topics, std::string_view name, std::string_view type,
                        std::string_view definition = {});

}  // namespace edged
