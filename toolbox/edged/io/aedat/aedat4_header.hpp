// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The header of an AEDAT4 file or server, and the choice of the streams to read. Internal to io.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/topic_choice.hpp"

namespace edged {

inline constexpr std::string_view kAedat4Magic = "#!AER-DAT4.0\r\n";
inline constexpr std::size_t kMostPacketBytes = std::size_t{1} << 28U;

inline constexpr const char* kAedat4PoseFrame = "edgedPoseFrame";  ///< key in the xml, which other programs ignore

struct Aedat4Stream {
  std::int32_t number = -1;
  std::string type;                  ///< "EVTS", "FRME", "IMUS", "TRIG", ...
  std::string name, source;          ///< "events", "DAVIS346_00000002"
  std::optional<cv::Size> geometry;  ///< [px]
};

struct Aedat4Header {
  std::string_view compression;  ///< a method of decompress()
  std::int64_t table_at = -1;    ///< offset of the table at the end of the file; -1: no table
  std::vector<Aedat4Stream> streams;
  std::string pose_frame = "body";  ///< of the recording before conversion; the format itself has no ground truth
};

/// buffer: without its length. Throws Damage.
Aedat4Header parse_aedat4_header(ByteSpan buffer);

/// The streams as topics. Those of the same name are distinguished by their source, then by their number.
std::vector<Topic> topics_of(const std::vector<Aedat4Stream>& streams);

}  // namespace edged
