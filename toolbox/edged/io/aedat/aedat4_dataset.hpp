// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The description of AEDAT4 for its readers and its writer: header, heads of packets, fields of the tables; and the
// content of packets, from a file or a server. Internal to io.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/streamed_dataset.hpp"
#include "edged/io/core/topic_choice.hpp"

namespace edged {

// FlatBuffers without generated code. Each access is checked to lie within the buffer.

/// A number at `offset`. Throws Damage beyond the end.
template <typename T>
T number_at(ByteSpan bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) throw Damage("points beyond its end");
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// A vector: `count` items from offset `at` on.
struct FlatVector {
  std::size_t at = 0, count = 0;
};

/// A table of a buffer. Fields are numbered from 0 in the order of the schema. Absent fields have their default value.
class FlatTable {
 public:
  /// The root table of a buffer.
  explicit FlatTable(ByteSpan buffer) : FlatTable(buffer, number_at<std::uint32_t>(buffer, 0)) {}

  template <typename T>
  T number(unsigned field, T otherwise = 0) const {
    const std::size_t at = place(field);
    return at ? number_at<T>(buffer_, at) : otherwise;
  }

  /// item_bytes: 1 for strings, 4 for tables. An absent vector is empty.
  FlatVector vector(unsigned field, std::size_t item_bytes) const {
    const std::size_t at = place(field);
    if (!at) return {};
    const std::size_t begin = at + number_at<std::uint32_t>(buffer_, at);
    const std::size_t count = number_at<std::uint32_t>(buffer_, begin);
    if (count > (buffer_.size() - begin - 4) / item_bytes) throw Damage("a list goes beyond its end");
    return {begin + 4, count};
  }

  ByteSpan bytes(unsigned field) const {
    const FlatVector list = vector(field, 1);
    return buffer_.subspan(list.at, list.count);
  }

  /// The table that item `index` of a vector of tables points to.
  FlatTable table(const FlatVector& list, std::size_t index) const {
    const std::size_t at = list.at + 4 * index;
    return {buffer_, at + number_at<std::uint32_t>(buffer_, at)};
  }

 private:
  FlatTable(ByteSpan buffer, std::size_t at) : buffer_(buffer), at_(at) {
    // The signed distance backwards from the table. As an unsigned offset, a wrong one lies beyond the buffer.
    const auto back = number_at<std::int32_t>(buffer_, at_);
    layout_ = at_ - static_cast<std::size_t>(static_cast<std::int64_t>(back));
    layout_bytes_ = number_at<std::uint16_t>(buffer_, layout_);
  }

  /// Offset of a field; 0 for an absent one.
  std::size_t place(unsigned field) const {
    const std::size_t entry = 4 + 2 * std::size_t{field};
    if (entry + 2 > layout_bytes_) return 0;
    const auto offset = number_at<std::uint16_t>(buffer_, layout_ + entry);
    return offset ? at_ + offset : 0;
  }

  ByteSpan buffer_;
  std::size_t at_;            ///< offset of the table
  std::size_t layout_;        ///< offset of the list of the offsets of its fields
  std::size_t layout_bytes_;  ///< length of that list
};

/// The type of a buffer: the four characters after the offset of the root table.
inline std::string_view flat_identifier(ByteSpan buffer) {
  if (buffer.size() < 8) throw Damage("ends too early");
  return as_text(buffer.subspan(4, 4));
}

/// A buffer after its length. Throws Damage if it is not of this type.
inline ByteSpan flat_buffer(ByteSpan bytes, std::string_view type) {
  ByteReader reader(bytes);
  const ByteSpan buffer = reader.take(reader.number<std::uint32_t>());
  if (flat_identifier(buffer) != type) throw Damage("is not of the type of its stream");
  return buffer;
}

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

/// The streams of a file or server: which are read, and their packets as measurements.
class Aedat4Dataset : public StreamedDataset {
 protected:
  using StreamedDataset::StreamedDataset;

  /// Chooses the streams: the only one of its type, those that the user names, or several cameras. The sizes of event
  /// sensors are those of the rig, else options.geometry, else those of the streams. Throws InputError.
  void choose(const std::vector<Aedat4Stream>& streams, const Rig* rig, const RecordingOptions& options);
  /// The frame of poses that the header names.
  void set_pose_frame(const std::string& name);
  void begin_chosen() { begin(cameras_, choice_.of(Role::Imu).has_value()); }

  /// Whether the packets of that stream, by its place in choose(), are needed.
  bool reads(std::size_t stream) const;
  /// One packet of a stream that is read. place: its position, for messages. Damage is counted.
  void take_packet(std::size_t stream, std::string_view compression, ByteSpan packed, const std::string& place);

 private:
  void take_events(std::size_t camera, ByteSpan buffer);
  void take_frame(std::size_t camera, ByteSpan buffer);
  void take_imu(ByteSpan buffer);

  TopicChoice choice_;
  std::vector<RecordedCamera> cameras_;
};

}  // namespace edged
