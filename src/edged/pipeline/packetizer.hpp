// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Cuts the measurement stream into packets: events since the last cut, an optional frame, and the IMU that covers them.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/rig.hpp"
#include "edged/core/config.hpp"
#include "edged/core/types.hpp"

namespace edged {

/// One step of the odometry. All stamps are on the IMU clock: camera time offsets are applied here, once, to events
/// and frames alike.
struct Packet {
  Timestamp t;                    ///< reference time: the frame's stamp, or the newest event's
  std::vector<Event> events;      ///< oldest first, all t <= packet t; overlaps the previous packet's (augmented packet)
  std::size_t new_events = 0;     ///< how many of them came since the previous packet (at the end of `events`)
  std::optional<Frame> frame;     ///< set when a frame cut the packet; its stamp is t
  std::vector<ImuSample> imu;     ///< from the previous packet's t (or the first sample) to t, both ends interpolated
  double event_rate_hz = 0.0;     ///< new events over the time since the previous packet
};

enum class Mode { Events, Frames, Fused };

/// When a packet is cut (architecture, section 4).
struct PacketizerConfig {
  double events_per_pixel = 0.35;   ///< a packet is cut after this many new events per pixel
  double window_per_pixel = 0.35;   ///< events a packet carries back in time, per pixel
  double max_interval_s = 0.04;     ///< a cut at the latest after this time (the heartbeat at standstill)
  double min_interval_s = 0.015;    ///< and never sooner than this after the last
  double max_frame_gap_s = 0.0;     ///< reserved by the packetizer's author; remove when not needed
  void visit(ConfigFields& fields);
};

/// Single-threaded; memory bounded by the window and by the IMU's delay.
class Packetizer {
 public:
  /// Uses the rig's first event camera (Events, Fused) and first frame camera (Frames, Fused).
  Packetizer(const Rig& rig, Mode mode, const PacketizerConfig& config);

  void add(Measurement measurement);
  /// The next packet whose IMU is complete, if there is one. Call until it returns nothing after each add.
  std::optional<Packet> next();
  /// The stream has ended: packets beyond the last IMU sample are dropped and counted.
  void finish();

 private:
  Mode mode_;
  PacketizerConfig config_;
};

}  // namespace edged
