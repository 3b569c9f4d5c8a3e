// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The events of all types of messages, those of event_camera_msgs packets on the clock of the headers' stamps.
#pragma once

#include <optional>

#include "edged/io/parse/evt.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged {

/// The clock of a sensor on that of the stamps. Aligned by the first packet, it then follows the drift between the two,
/// by at most 500 ppm and with a time constant of 5 s, so that intervals are those of the sensor, without the jitter
/// of the stamps.
class SensorClock {
 public:
  /// What to add to the times of a packet with these first and last ones. Does not turn the order of two packets round.
  Duration offset(Timestamp first, Timestamp last, Timestamp stamp);
  void reset() { offset_.reset(); }

 private:
  std::optional<Duration> offset_;
  Timestamp last_first_, last_last_;  ///< stamps of the packet before
};

/// Decodes the event messages of one stream, in order: all types of event arrays, and packets in the encodings evt3,
/// evt21, evt2, mono, libcaer and libcaer_cmp. The clock of the sensor (of the first four) is aligned anew after
/// missing packets.
class EventMessageDecoder {
 public:
  /// type: one with the role Events. Throws Damage.
  EventArray decode(std::string_view type, WireReader message);
  /// Throws Damage for packets that it cannot decode, also for other encodings.
  std::vector<Event> decode(const EventPacket& packet);

  /// Events that could not be decoded, most of them after missing packets: without time, or outside every sensor.
  std::size_t left_out() const;

 private:
  struct Evt {
    EvtFormat format;
    EvtDecoder decoder;
  };
  /// The decoder of the stream, kept from packet to packet.
  EvtDecoder& evt(EvtFormat format);

  std::optional<Evt> evt_;
  std::uint16_t column_ = 0;               ///< column in libcaer_cmp, kept from packet to packet
  std::optional<std::uint64_t> sequence_;  ///< number of the last packet
  SensorClock clock_;
};

}  // namespace edged
