// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Constants of the MCAP format, for its reader and its writer.
#pragma once

#include <cstdint>
#include <string_view>

namespace edged {

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";  // at both ends

enum McapOp : std::uint8_t {
  kMcapHeader = 1,
  kMcapFooter = 2,
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapMessageIndex = 7,
  kMcapChunkIndex = 8,
  kMcapStatistics = 0x0B,
  kMcapMetadata = 0x0C,
  kMcapMetadataIndex = 0x0D,
  kMcapDataEnd = 0x0F
};

}  // namespace edged
