// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Encodes the parts of AEDAT4 files and streams.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "edged/dataset.hpp"

namespace edged {

/// Encodes the parts of a file in the order of the calls. Stream 0 holds the events, 1 the frames, 2 the IMU; events
/// and frames of further cameras follow. Stamps are rounded down to whole microseconds.
class Aedat4Encoder {
 public:
  /// The numbers in the header: none, LZ4, LZ4 high, zstd, zstd high.
  enum class Compression : std::int32_t { None, Lz4, Lz4High, Zstd, ZstdHigh };

  /// pose_frame: of the DatasetInfo, kept in the header.
  Aedat4Encoder(Compression compression, cv::Size sensor, std::string pose_frame = "body")
      : compression_(compression), sensors_{sensor}, pose_frame_(std::move(pose_frame)) {}

  /// For several cameras, before the header: the size of each event sensor, and the number of frame cameras.
  void set_cameras(std::vector<cv::Size> sensors, std::size_t frame_cameras);

  /// Version line and header. Their length does not depend on the offset of the table (-1: no table).
  std::string header(std::int64_t table_at = -1) const;
  std::string events(std::span<const Event> events, std::size_t camera = 0);
  /// The stamp is the middle of the exposure. The image may have any type.
  std::string frame(const Frame& frame, Duration exposure = Duration(0), std::size_t camera = 0);
  /// Written as single-precision numbers in g and deg/s.
  std::string imu(std::span<const ImuSample> samples);
  /// The table of all packets so far.
  std::string table() const;

 private:
  struct PacketEntry {
    std::int64_t at;  ///< offset of the body
    std::int32_t stream, bytes;
    std::int64_t count, first_us, last_us;
  };

  std::string header_xml() const;
  int stream_of(Modality modality, std::size_t camera) const;
  std::string packed(const std::string& body) const;
  std::string packet(PacketEntry entry, const std::string& body);

  Compression compression_;
  std::vector<cv::Size> sensors_;  ///< sizes of the event cameras
  std::size_t frame_cameras_ = 1;
  std::string pose_frame_;
  std::vector<PacketEntry> packets_;
  std::int64_t packets_bytes_ = 0;
};

}  // namespace edged
