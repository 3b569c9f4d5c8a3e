// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Definitions of message types, for writing bags and for messages to and from ROS.
#pragma once

#include <string>
#include <string_view>

#include "edged/io/ros/messages/wire.hpp"

namespace edged {

struct MessageDefinition {
  std::string text;  ///< its fields, then those of each contained message, in the form of ROS 1 or 2
  std::string md5;   ///< checksum by which ROS 1 identifies the version of a message; empty for CDR
};

/// type: "dvs_msgs/EventArray" or another one of the table. Throws CheckError for other types.
MessageDefinition definition_of(std::string_view type, Wire wire);

/// The md5 by which ROS 1 identifies the type. Empty for a type that is not in the table.
std::string_view ros1_md5_of(std::string_view type);

}  // namespace edged
