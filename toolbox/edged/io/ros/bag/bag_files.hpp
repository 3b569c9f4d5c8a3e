// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files of a bag in several consecutive ones: folders of ROS 2, and the parts of `rosbag record --split`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace edged {

/// The .db3 or .mcap files of a folder, also compressed as .zstd, in the order of their numbers. Empty if there are
/// none. metadata.yaml is not needed: crashed recorders do not write it, and the files contain the same information.
std::vector<std::filesystem::path> bag_parts(const std::filesystem::path& folder);

/// The files of the bag whose first part is given, NAME_0.bag, NAME_1.bag and so on, in this order. Only the given file
/// if it is no first part.
std::vector<std::filesystem::path> split_bag_parts(const std::filesystem::path& first);

/// Names of the missing files of a bag in these parts, by the list in metadata.yaml, else by their numbers.
std::vector<std::string> missing_parts(const std::vector<std::filesystem::path>& parts);

}  // namespace edged
