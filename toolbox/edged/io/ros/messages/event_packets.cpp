// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/messages/event_packets.hpp"

#include <algorithm>

#include "edged/io/parse/text_parsing.hpp"

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

/// Words of 16 bits: kind 4, value 12. Times are microseconds since the time base, which is on the clock of the stamps.
/// A column is valid until the next one. Events are single, or bits for eight rows from a base row on.
std::vector<Event> decode_libcaer_cmp(const EventPacket& packet, std::uint16_t& column) {
  enum Kind : std::uint8_t { TimeHigh, TimeLow, Column, Row, BaseRow, EightRows };
  check_time_base(packet);
  std::vector<Event> events;
  std::uint64_t high = 0, low = 0;
  std::uint16_t base_row = 0;
  bool positive = false;
  const auto add = [&](unsigned row, bool polarity) {
    const auto t = static_cast<std::int64_t>(packet.time_base + (high << 12U | low) * 1000);
    events.push_back({timestamp_from_ns(t), column, static_cast<std::uint16_t>(row), polarity});
  };
  for (ByteReader reader(packet.events); reader.left() >= 2;) {
    const auto word = reader.number<std::uint16_t>();
    const std::uint16_t value = word & 0xFFFU, pixel = word & 0x7FFU;
    const bool polarity = (word >> 11U & 1U) != 0;
    switch (word >> 12U) {
      case TimeHigh:
        high = value;
        break;
      case TimeLow:
        low = value;
        break;
      case Column:
        column = pixel;
        break;
      case Row:
        add(pixel, polarity);
        break;
      case BaseRow:
        base_row = pixel;
        positive = polarity;
        break;
      case EightRows:
        for (unsigned i = 0; i < 8; ++i)
          if ((word >> i & 1U) != 0) add(base_row + i, positive);
        base_row = static_cast<std::uint16_t>(base_row + 8);
        break;
      default:
        throw Damage("word of a kind that libcaer_cmp does not have");
    }
  }
  return events;
}

std::optional<EvtFormat> evt_format(std::string_view encoding) {
  if (encoding == "evt3") return EvtFormat::Evt3;
  if (encoding == "evt21") return EvtFormat::Evt21;
  return encoding == "evt2" ? std::optional(EvtFormat::Evt2) : std::nullopt;
}

}  // namespace

/// Stamps of arrival are late after a stall, too, but by less with each packet that had to wait.
bool SensorClock::is_set(Timestamp first, Timestamp stamp, Duration off) {
  constexpr auto kJitter = std::chrono::milliseconds(5), kConfirmed = std::chrono::milliseconds(20);
  if (std::chrono::abs(off) < kStep) {
    apart_.reset();
    return false;
  }
  if (apart_ && first < apart_->since) apart_.reset();
  if (!apart_ || std::chrono::abs(off - apart_->step.stamps_by) > (first - apart_->since) / 2 + kJitter)
    apart_ = {first, {off, std::chrono::abs(stamp - last_stamp_) > std::chrono::abs(first - last_first_)}};
  return first - apart_->since >= kConfirmed;
}

Duration SensorClock::offset(Timestamp first, Timestamp last, Timestamp stamp) {
  constexpr double kFastest = 5e-4, kTimeConstant_s = 5.0;
  constexpr std::size_t kMostSteps = 1000;
  const Duration off = offset_ ? stamp - first - *offset_ : Duration(0);
  if (!offset_) {
    offset_ = stamp - first;
  } else if (is_set(first, stamp, off)) {
    *offset_ += off;
    if (steps_.size() < kMostSteps) steps_.push_back({off, apart_->step.of_stamps});
    apart_.reset();
  } else if (!apart_ && first >= last_last_) {
    const double passed_s = to_seconds(first - last_first_);
    const double wanted_s = to_seconds(off) * std::min(passed_s / kTimeConstant_s, 1.0), most_s = kFastest * passed_s;
    *offset_ += std::max(duration_from_seconds(std::clamp(wanted_s, -most_s, most_s)), last_last_ - first);
  }
  last_first_ = first;
  last_last_ = last;
  last_stamp_ = stamp;
  return *offset_;
}

EvtDecoder& EventMessageDecoder::evt(EvtFormat format) {
  constexpr int kMostSide = 1 << 11;  // of the coordinates of its words
  if (!evt_ || evt_->format != format) {
    evt_.emplace(Evt{format, EvtDecoder(format, kMostSide, kMostSide)});
    clock_.reset();
  }
  return evt_->decoder;
}

std::size_t EventMessageDecoder::left_out() const {
  return evt_ ? evt_->decoder.counts().untimed + evt_->decoder.counts().outside : 0;
}

std::vector<Event> EventMessageDecoder::decode(const EventPacket& packet) {
  if (sequence_ && packet.sequence != *sequence_ + 1) {
    clock_.reset();
    if (evt_) evt_->decoder.reset();
    column_ = 0;
  }
  sequence_ = packet.sequence;
  if (packet.encoding == "libcaer") return decode_libcaer(packet);
  if (packet.encoding == "libcaer_cmp") return decode_libcaer_cmp(packet, column_);

  std::vector<Event> events;
  if (const auto format = evt_format(packet.encoding)) {
    evt(*format).decode(packet.events, events);
  } else if (packet.encoding == "mono") {
    events = decode_mono(packet);
  } else {
    throw Damage("encoding `" + std::string(packet.encoding) +
                 "` is none of evt3, evt21, evt2, mono, libcaer, libcaer_cmp");
  }
  if (events.empty()) return events;
  // The stamp is that of the first event; the times of mono are relative to its time base.
  const Timestamp begin =
      packet.encoding == "mono" ? timestamp_from_ns(static_cast<std::int64_t>(packet.time_base)) : events.front().t;
  const Duration offset = clock_.offset(begin, events.back().t, packet.stamp);
  for (Event& event : events) event.t += offset;
  return events;
}

EventArray EventMessageDecoder::decode(std::string_view type, WireReader message) {
  constexpr std::uint32_t kMostSide = 16384;  // the limit of --geometry
  EventArray array;
  if (type == "event_camera_msgs/EventPacket" || type == "event_array_msgs/EventArray") {
    const EventPacket packet = read_event_packet(message);
    array = {packet.width, packet.height, decode(packet)};
  } else {
    array = read_event_array(message);
  }
  if (array.width > kMostSide || array.height > kMostSide) throw Damage("a sensor of that size");
  return array;
}

}  // namespace edged
