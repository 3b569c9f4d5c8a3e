// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens bags, and detects the container by the content: ROS 1 bag, SQLite (reading only) or MCAP. The interfaces for
// reading and writing its messages.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/archive/compression.hpp"
#include "edged/io/core/topic_choice.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/ros/messages/wire.hpp"

namespace edged {

/// A file, and the name of the one that it was unpacked from.
struct BagFile {
  std::filesystem::path path;
  std::string name;
};

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
  std::optional<Message> next() { return read(std::nullopt); }
  /// The next message of that topic. With an index, the messages before it are not read.
  std::optional<Message> next_of(std::size_t topic) { return read(topic); }

  /// The next message of any topic, or of one.
  virtual std::optional<Message> read(std::optional<std::size_t> only) = 0;
};

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

/// Index of the topic of that name and type, which is added if it is new. "pkg/msg/Name" becomes "pkg/Name".
std::size_t topic_index(std::vector<Topic>& topics, std::string_view name, std::string_view type,
                        std::string_view definition = {});
/// The type in ROS 2: "pkg/msg/Name" of "pkg/Name".
std::string ros2_type(std::string_view type);

/// Opens a bag: a file or folder. Throws InputError if it is no bag. repairs may be null, here and below: then damage
/// is not counted.
std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, Repairs* repairs);

// The containers of one file. They throw InputError for a file without messages.

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";  // at both ends
std::unique_ptr<MessageSource> open_ros1_bag(const BagFile& file, Repairs* repairs);
std::unique_ptr<MessageSource> open_mcap(const BagFile& file, Repairs* repairs);
std::unique_ptr<MessageSource> open_db3(const BagFile& file, Repairs* repairs);

/// A new ROS 1 bag, whose chunks are compressed by "none" or "lz4". MCAP: McapWriter.
std::unique_ptr<MessageSink> create_ros1_bag(const std::filesystem::path& file,
                                             const ChunkOptions& options = {.compression = "lz4"});

}  // namespace edged
