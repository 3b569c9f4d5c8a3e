// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The events of event_camera_msgs packets, on the clock of the headers' stamps.
#pragma once

#include <optional>

#include "edged/io/evt.hpp"
#include "edged/io/ros/messages.hpp"

namespace edged {

/// Encodings evt3, mono, libcaer and libcaer_cmp. Sensors with a clock of their own (those of the first two) are set to
/// that of the stamps once, by the first packet and again where packets are missing: their distances are the sensor's,
/// without the jitter of the stamps.
class EventPacketDecoder {
 public:
  /// Throws Damage for what it cannot decode, other encodings among it.
  std::vector<Event> decode(const EventPacket& packet);

 private:
  EvtDecoder evt3_{EvtFormat::Evt3, 1 << 11, 1 << 11};  // as many pixels as its words can name
  std::uint16_t column_ = 0;                            ///< of libcaer_cmp, kept from packet to packet
  std::optional<std::uint64_t> sequence_;               ///< of the last packet
  std::optional<Duration> sensor_to_stamps_;
};

}  // namespace edged
