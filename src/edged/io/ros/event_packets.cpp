// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The encodings of event packets.
#include "edged/io/ros/event_packets.hpp"

#include "edged/io/text.hpp"

namespace edged {
namespace {

void check_time_base(const EventPacket& packet) {
  if (packet.time_base > static_cast<std::uint64_t>(kMaxStampNs)) throw Damage("time base out of range");
}

/// 64 bits each: polarity 1, row 15, column 16, nanoseconds since the time base 32.
std::vector<Event> decode_mono(const EventPacket& packet) {
  check_time_base(packet);
  std::vector<Event> events(packet.events.size() / 8);
  ByteReader reader(packet.events);
  for (Event& event : events) {
    const auto word = reader.number<std::uint64_t>();
    event.t = timestamp_from_ns(static_cast<std::int64_t>(packet.time_base + (word & 0xFFFFFFFFU)));
    event.x = static_cast<std::uint16_t>(word >> 32U);
    event.y = static_cast<std::uint16_t>((word >> 48U) & 0x7FFFU);
    event.positive = (word >> 63U) != 0;
  }
  return events;
}

/// 32 bits: column 15, row 15, polarity 1, valid 1; then 31 bits of microseconds since the time base, which is on the
/// clock of the stamps and may roll over within the packet.
std::vector<Event> decode_libcaer(const EventPacket& packet) {
  constexpr std::uint64_t kRollOver = 1ULL << 31U;
  check_time_base(packet);
  std::vector<Event> events(packet.events.size() / 8);
  ByteReader reader(packet.events);
  std::uint64_t high_us = 0, last_us = 0;
  for (Event& event : events) {
    const auto word = reader.number<std::uint32_t>();
    const std::uint64_t us = reader.number<std::uint32_t>() & (kRollOver - 1);
    if (us + kRollOver / 2 < last_us) high_us += kRollOver;
    last_us = us;
    event.t = timestamp_from_ns(static_cast<std::int64_t>(packet.time_base + (high_us + us) * 1000));
    event.x = static_cast<std::uint16_t>(word >> 17U);
    event.y = static_cast<std::uint16_t>((word >> 2U) & 0x7FFFU);
    event.positive = ((word >> 1U) & 1U) != 0;
  }
  return events;
}

}  // namespace

std::vector<Event> EventPacketDecoder::decode(const EventPacket& packet) {
  if (sequence_ && packet.sequence != *sequence_ + 1) {
    sensor_to_stamps_.reset();
    evt3_.reset();
  }
  sequence_ = packet.sequence;
  if (packet.encoding == "libcaer") return decode_libcaer(packet);

  std::vector<Event> events;
  if (packet.encoding == "evt3") {
    evt3_.decode(packet.events, events);
  } else if (packet.encoding == "mono") {
    events = decode_mono(packet);
  } else {
    throw Damage("encoding `" + std::string(packet.encoding) + "` is none of evt3, mono and libcaer");
  }
  if (events.empty()) return events;
  // The stamp is that of the first event; mono says from where it counts.
  const Timestamp begin =
      packet.encoding == "mono" ? timestamp_from_ns(static_cast<std::int64_t>(packet.time_base)) : events.front().t;
  if (!sensor_to_stamps_) sensor_to_stamps_ = packet.stamp - begin;
  for (Event& event : events) event.t += *sensor_to_stamps_;
  return events;
}

}  // namespace edged
