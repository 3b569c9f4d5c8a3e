// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4, written: as bytes of packets, and as a file with its table.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "edged/io/recording_writer.hpp"

namespace edged {

/// Makes the parts of a file in the order of the calls; stream 0 holds the events, 1 the frames, 2 the IMU. Stamps are
/// cut to whole microseconds.
class Aedat4Encoder {
 public:
  /// The number in the header: none, LZ4, LZ4 high, zstd, zstd high.
  enum class Compression : std::int32_t { None, Lz4, Lz4High, Zstd, ZstdHigh };

  /// pose_frame: of the DatasetInfo, kept in the header.
  Aedat4Encoder(Compression compression, cv::Size sensor, std::string pose_frame = "body")
      : compression_(compression), sensor_(sensor), pose_frame_(std::move(pose_frame)) {}

  /// Version line and header; as long for every place of the table (-1: there is none).
  std::string header(std::int64_t table_at = -1) const;
  /// The header alone, as servers send it.
  std::string network_header() const;
  std::string events(std::span<const Event> events);
  /// The stamp is the middle of the exposure; the image of any type.
  std::string frame(const Frame& frame, Duration exposure = Duration(0));
  /// As single-precision numbers in g and deg/s.
  std::string imu(std::span<const ImuSample> samples);
  /// Of all packets so far.
  std::string table() const;

 private:
  struct PacketEntry {
    std::int64_t at;  ///< of the body
    std::int32_t stream, bytes;
    std::int64_t count, first_us, last_us;
  };

  std::string packed(const std::string& body) const;
  std::string packet(PacketEntry entry, const std::string& body);

  Compression compression_;
  cv::Size sensor_;
  std::string pose_frame_;
  std::vector<PacketEntry> packets_;
  std::int64_t packets_bytes_ = 0;
};

/// LZ4, with a table; stamps in whole microseconds from 0 on.
std::unique_ptr<RecordingWriter> write_aedat4(const WriterSetup& setup);

}  // namespace edged
