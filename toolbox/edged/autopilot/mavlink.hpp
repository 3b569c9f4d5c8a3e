// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The MAVLink 2 messages that an odometry needs: ODOMETRY and HEARTBEAT out, TIMESYNC in and out. No signatures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "edged/autopilot/vehicle_odometry.hpp"

namespace edged {

using MavlinkFrame = std::vector<std::uint8_t>;

/// CRC-16/MCRF4XX, the checksum of a frame. crc: of the bytes before.
std::uint16_t mavlink_crc(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0xFFFF);

/// A message by its number. crc_extra is the hash of its fields that keeps apart programs with other definitions: the
/// CRC of "NAME " and "type field " of each field in the order of the wire, an array followed by the byte of its
/// length, without extensions; its two bytes combined by exclusive or. The test derives it.
struct MavlinkMessage {
  std::uint32_t id;
  std::uint8_t crc_extra;
};
inline constexpr MavlinkMessage kMavlinkHeartbeat{0, 50}, kMavlinkTimesync{111, 34}, kMavlinkOdometry{331, 91};

struct MavlinkIds {
  std::uint8_t system = 1, component = 197;
};

/// Fields of a TIMESYNC message [ns]: tc1 is 0 in a request; the reply has the time of the one who replies there, and
/// ts1 as it came.
struct MavlinkTimesync {
  std::int64_t tc1 = 0, ts1 = 0;
  MavlinkIds from;
};

/// Frames of one sender, numbered one after the other.
class MavlinkEncoder {
 public:
  explicit MavlinkEncoder(MavlinkIds ids) : ids_(ids) {}

  /// Stamped with timestamp_sample. Pose in LOCAL_FRD, velocities in BODY_FRD, the only pair that ArduPilot accepts.
  MavlinkFrame odometry(const VehicleOdometry& odometry);
  /// The heartbeat of an onboard controller that is no autopilot.
  MavlinkFrame heartbeat();
  /// The reply to a request, at time now_ns of the clock that ODOMETRY is stamped with.
  MavlinkFrame timesync(const MavlinkTimesync& request, std::int64_t now_ns);

 private:
  MavlinkFrame frame(const MavlinkMessage& message, std::vector<std::uint8_t> payload);

  MavlinkIds ids_;
  std::uint8_t sequence_ = 0;
};

/// Finds the TIMESYNC requests among what an autopilot sends. Keeps less than one frame of the bytes.
class MavlinkDecoder {
 public:
  /// Bytes in the order of their arrival. Returns the requests that are complete, none damaged.
  std::vector<MavlinkTimesync> add(std::span<const std::uint8_t> bytes);

 private:
  std::vector<std::uint8_t> pending_;
};

}  // namespace edged
