// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The events of all types of messages, those of event_camera_msgs packets on the clock of the headers' stamps.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "edged/io/parse/evt.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged {

/// One of two clocks has been set.
struct ClockStep {
  Duration stamps_by{0};   ///< by which stamps are later than by the sensor's clock since then
  bool of_stamps = false;  ///< whether it was their clock, as the computer's by NTP, not the sensor's
};

/// The clock of a sensor on that of the stamps. Aligned by the first packet, it then follows the drift between the two,
/// by at most 500 ppm and with a time constant of 5 s, so that intervals are those of the sensor, without the jitter
/// of the stamps. Where one of the two clocks is set, as the computer's by NTP after its start, it is aligned anew:
/// when they have stayed apart by kStep or more, and by as much, for 20 ms of the sensor's time.
class SensorClock {
 public:
  static constexpr Duration kStep = std::chrono::milliseconds(25);  ///< less is jitter of the stamps

  /// What to add to the times of a packet with these first and last ones. Does not turn the order of two packets round.
  Duration offset(Timestamp first, Timestamp last, Timestamp stamp);
  void reset() { *this = SensorClock(steps_); }
  const std::vector<ClockStep>& steps() const { return steps_; }
  bool known() const { return offset_.has_value(); }
  /// The stamp of the newest packet.
  Timestamp stamp() const { return last_stamp_; }
  /// The newest packet was not where the clocks put it: one of the two may have been set.
  bool in_doubt() const { return apart_.has_value(); }

  SensorClock() = default;

 private:
  struct Apart {
    Timestamp since;  ///< by the sensor's clock
    ClockStep step;
  };
  explicit SensorClock(std::vector<ClockStep> steps) : steps_(std::move(steps)) {}
  bool is_set(Timestamp first, Timestamp stamp, Duration off);

  std::optional<Duration> offset_;
  std::optional<Apart> apart_;
  std::vector<ClockStep> steps_;
  Timestamp last_first_, last_last_, last_stamp_;  ///< of the packet before
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
  const SensorClock& clock() const { return clock_; }

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
