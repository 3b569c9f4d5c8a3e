// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The description of AEDAT4 for its readers and its writer: header, heads of packets, fields of the tables.
#pragma once

#include <array>
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

/// Compressions by their number in the header: the method of decompress(), and the name in the xml.
struct Aedat4Compression {
  std::string_view method;
  const char* name;
};
inline constexpr std::array<Aedat4Compression, 5> kAedat4Compressions = {
    {{"none", "NONE"}, {"lz4", "LZ4"}, {"lz4", "LZ4_HIGH"}, {"zstd", "ZSTD"}, {"zstd", "ZSTD_HIGH"}}};

/// Numbers of fields in the tables of the format.
namespace aedat4 {
enum Header : unsigned { kCompression, kTableAt, kXml };
enum Frame : unsigned { kStamp, kBegin, kEnd, kExposureBegin, kExposureEnd, kType, kWidth, kHeight, kPixels = 10 };
enum Imu : unsigned { kImuStamp, kAccel = 2, kGyro = 5 };  // three numbers each [g], [deg/s]
enum TableEntry : unsigned { kBodyAt, kStreamAndBytes, kCount, kFirstStamp, kLastStamp };
inline constexpr unsigned kItems = 0;  // of lists: events, IMU samples, entries
}  // namespace aedat4

struct Aedat4Stream {
  std::int32_t number = -1;
  std::string type;                  ///< "EVTS", "FRME", "IMUS", "TRIG", ...
  std::string name, source;          ///< "events", "DAVIS346_00000002"
  std::optional<cv::Size> geometry;  ///< [px]
};

struct Aedat4Header {
  std::string_view compression;  ///< the method of decompress()
  std::int64_t table_at = -1;    ///< offset of the table at the end of the file; -1: no table
  std::vector<Aedat4Stream> streams;
  std::string pose_frame = "body";  ///< the one of the recording before conversion; the format has no ground truth
};

/// buffer: without its length. Throws Damage.
Aedat4Header parse_aedat4_header(ByteSpan buffer);

inline constexpr std::size_t kPacketHeadBytes = 8;

struct Aedat4PacketHead {
  std::int32_t number = -1, bytes = 0;  ///< number of the stream, length of the body
  std::optional<std::size_t> stream;    ///< place of the stream in the header; nothing for a head that no packet has
};
/// head: at least its bytes.
Aedat4PacketHead parse_packet_head(ByteSpan head, const std::vector<Aedat4Stream>& streams);

/// The streams as topics. Those of the same name are distinguished by their source, then by their number.
std::vector<Topic> topics_of(const std::vector<Aedat4Stream>& streams);

}  // namespace edged
