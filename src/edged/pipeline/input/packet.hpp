// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The input of one step of the odometry: the measurements of its cameras since the last one, and the IMU that covers
// it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/events/flicker.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// The events of one event camera in a packet.
struct PacketEvents {
  std::string camera;
  std::vector<Event> events;   ///< oldest first, all t <= packet t; overlaps the previous packet's (augmented packet)
  std::size_t new_events = 0;  ///< how many of them came since the previous packet (at the end of `events`)
  std::size_t window_events = 0;       ///< how many to render (at the end of `events`)
  double event_rate_hz = 0.0;          ///< new events over the time since the previous cut, at least 1 ms
  std::optional<LampCycle> lamp = {};  ///< a lamp that flickers

  /// The events of the event frame: the newest window_per_pixel * pixels, none older than max_age_s.
  std::span<const Event> window() const { return std::span<const Event>(events).last(window_events); }
};

/// All stamps are on the IMU clock: camera time offsets are applied once, to events and frames alike.
struct Packet {
  Timestamp t;                       ///< reference time, the instant of the cut: the first frame's stamp, the stamp of
                                     ///< the event that completed a count, or where a time limit fell
  std::vector<PacketEvents> events;  ///< one per event camera of the run, in its order
  std::vector<Frame> frames;   ///< frames that cut the packet, at most one per camera: stamps from t to 1 ms after it
  std::vector<ImuSample> imu;  ///< from the previous packet's t (or the first sample) to t, both ends interpolated
  std::vector<ExternalSample> external;  ///< after the start of `imu`, up to t; in the order of their stamps

  /// The lamp that flickers, by the first event camera that knows one.
  std::optional<LampCycle> lamp() const {
    const auto found = std::ranges::find_if(events, [](const PacketEvents& of) { return of.lamp.has_value(); });
    return found == events.end() ? std::nullopt : found->lamp;
  }
  /// Null if that camera has none.
  const Frame* find_frame(const std::string& camera) const {
    const auto found = std::ranges::find(frames, camera, &Frame::camera);
    return found == frames.end() ? nullptr : &*found;
  }
};

}  // namespace edged
