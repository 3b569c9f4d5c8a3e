// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Bags opened, the container found by content.
#pragma once

#include <filesystem>
#include <memory>

#include "edged/io/repairs.hpp"
#include "edged/io/ros/message_source.hpp"

namespace edged {

/// Whether a file that begins so is a bag, or compressed as ROS 2 compresses whole bags.
bool is_bag(ByteSpan head);
/// Whether the folder is that of a ROS 2 bag.
bool is_bag_folder(const std::filesystem::path& folder);

/// Opens a file or folder that is a bag; throws InputError where it is none. repairs may be null: then nothing is
/// counted.
std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, Repairs* repairs);

}  // namespace edged
