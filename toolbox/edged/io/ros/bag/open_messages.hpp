// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens bags, and detects the container by the content.
#pragma once

#include <filesystem>
#include <memory>

#include "edged/io/archive/compression.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/ros/bag/message_source.hpp"

namespace edged {

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
