// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What an AEDAT4 file or server says of itself before its packets, and which of its streams are read. Internal to io.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/bytes.hpp"
#include "edged/io/topic_choice.hpp"

namespace edged {

inline constexpr std::string_view kAedat4Magic = "#!AER-DAT4.0\r\n";
inline constexpr std::size_t kMostPacketBytes = std::size_t{1} << 28U;

inline constexpr const char* kAedat4PoseFrame = "edgedPoseFrame";  ///< key in its xml that other programs pass over

struct Aedat4Stream {
  std::int32_t number = -1;
  std::string type;                  ///< "EVTS", "FRME", "IMUS", "TRIG", ...
  std::string name, source;          ///< "events", "DAVIS346_00000002"
  std::optional<cv::Size> geometry;  ///< [px]
};

struct Aedat4Header {
  std::string_view compression;  ///< as decompress() names it
  std::int64_t table_at = -1;    ///< of the table at the end of the file; -1: it has none
  std::vector<Aedat4Stream> streams;
  std::string pose_frame = "body";  ///< of what was converted: the format holds no ground truth to tell it
};

/// From the buffer behind its length. Throws Damage.
Aedat4Header parse_aedat4_header(ByteSpan buffer);

/// Which streams are events, frames and IMU, as indices of `streams`: the only one of its type or the one the user
/// names. Streams of one name are told apart by their source, then by their number. Throws InputError that lists them.
TopicChoice choose_streams(const std::vector<Aedat4Stream>& streams, const WantedTopics& wanted,
                           const std::string& file);

}  // namespace edged
