// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What messages consist of that are written, or that ROS itself hands over, as its tools want it told.
#pragma once

#include <string>
#include <string_view>

#include "edged/io/ros/message_source.hpp"

namespace edged {

struct MessageDefinition {
  std::string text;  ///< fields, then those of every message in it, as ROS 1 or 2 puts them
  std::string md5;   ///< by which ROS 1 knows versions of a message; empty for CDR
};

/// type: "dvs_msgs/EventArray" or another one that is known here (CheckError for any other).
MessageDefinition definition_of(std::string_view type, Wire wire);

/// The md5 by which ROS 1 knows the type; empty for one that is not known here.
std::string_view ros1_md5_of(std::string_view type);

}  // namespace edged
