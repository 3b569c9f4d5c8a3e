// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The events of event_camera_msgs packets, on the clock of the headers' stamps.
#pragma once

#include <optional>

#include "edged/io/evt.hpp"
#include "edged/io/ros/messages.hpp"

namespace edged {

/// Decodes the encodings evt3, evt21, evt2, mono, libcaer and libcaer_cmp. The clock of the sensor (of the first four)
/// is aligned to the stamps by the first packet, and again after missing packets. So the intervals between events are
/// those of the sensor, without the jitter of the stamps.
class EventPacketDecoder {
 public:
  /// Throws Damage for packets that it cannot decode, also for other encodings.
  std::vector<Event> decode(const EventPacket& packet);

 private:
  struct Evt {
    EvtFormat format;
    EvtDecoder decoder;
  };
  /// The decoder of the stream, kept from packet to packet.
  EvtDecoder& evt(EvtFormat format);

  std::optional<Evt> evt_;
  std::uint16_t column_ = 0;               ///< of libcaer_cmp, kept from packet to packet
  std::optional<std::uint64_t> sequence_;  ///< of the last packet
  std::optional<Duration> sensor_to_stamps_;
};

}  // namespace edged
