// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Constants of the ROS 1 bag format 2.0, for its reader and its writer.
#pragma once

#include <cstdint>
#include <string_view>

namespace edged {

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

enum BagOp : std::uint8_t {
  kBagMessage = 2,
  kBagHeader = 3,
  kBagIndex = 4,
  kBagChunk = 5,
  kBagChunkInfo = 6,
  kBagConnection = 7
};

}  // namespace edged
