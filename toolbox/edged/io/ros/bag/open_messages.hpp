// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens bags, and detects the container by the content.
#pragma once

#include <filesystem>
#include <memory>

#include "edged/io/parse/repairs.hpp"
#include "edged/io/ros/bag/message_source.hpp"

namespace edged {

/// True for the first bytes of a bag, or of a bag that ROS 2 compressed as a whole.
bool is_bag(ByteSpan head);
/// True for the folder of a ROS 2 bag.
bool is_bag_folder(const std::filesystem::path& folder);

/// Opens a bag: a file or folder. Throws InputError if it is no bag. repairs may be null: then damage is not counted.
std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, Repairs* repairs);

}  // namespace edged
