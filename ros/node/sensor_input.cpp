// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/sensor_input.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "edged/io/ros/definitions.hpp"
#include "edged/io/ros/messages.hpp"

namespace edged::node {
namespace {

constexpr Duration kJumpAhead = std::chrono::seconds(1);
constexpr std::uint64_t kMostMissed = 1'000'000;  // a larger gap is a new way of counting

bool is_packet(std::string_view type) { return type == "event_camera_msgs/EventPacket"; }

}  // namespace

std::string sensor_text(Role role, const std::string& camera) {
  return fmt::format("{}{}{}", kRoleNames[static_cast<std::size_t>(role)], camera.empty() ? "" : " of ", camera);
}

std::optional<Measurement> SensorInput::read(const WireMessage& message) {
  std::optional<Measurement> measurement;
  std::string trouble;
  try {
    // Every header of ROS 1 begins with it; those of ROS 2 have none.
    if (wire_ == Wire::Ros1) note_number(ByteReader(message.bytes).number<std::uint32_t>());
    measurement = decode(message);
  } catch (const Damage& damage) {
    trouble = fmt::format("{}: {}", message.type, damage.what());
  }
  const std::lock_guard lock(mutex_);
  ++counters_.messages;
  if (!measurement) {
    ++counters_.unreadable;
    counters_.trouble = std::move(trouble);
  } else if (const auto* batch = std::get_if<EventBatch>(&*measurement)) {
    counters_.events += batch->events.size();
  }
  return measurement;
}

Measurement SensorInput::decode(const WireMessage& message) {
  if (!can_take(message.type, role_))
    throw Damage(fmt::format("cannot be {}; remap the topic", kRoleNames[static_cast<std::size_t>(role_)]));
  const std::string_view md5 = wire_ == Wire::Ros1 ? ros1_md5_of(message.type) : "";
  if (!md5.empty() && md5 != message.md5)
    throw Damage(fmt::format("of another version: md5 {}, not {}", message.md5, md5));
  const WireReader reader(wire_, message.bytes);
  switch (role_) {
    case Role::Events:
      return decode_events(message);
    case Role::Frames: {
      GrayImage gray = read_frame(message.type, reader);
      return Frame{gray.t, camera_, std::move(gray.image)};
    }
    case Role::Imu:
      return read_imu(reader);
    default:
      return read_external(message.type, reader);
  }
}

EventBatch SensorInput::decode_events(const WireMessage& message) {
  const WireReader reader(wire_, message.bytes);
  EventBatch batch{camera_, decoder_.decode(message.type, reader).events};
  if (is_packet(message.type)) note_packet(read_event_packet(reader), batch.events);
  return batch;
}

void SensorInput::note_packet(const EventPacket& packet, const std::vector<Event>& events) {
  if (wire_ == Wire::Cdr) note_number(packet.sequence);
  std::size_t back = 0, ahead = 0;
  for (std::size_t i = 1; i < events.size(); ++i) {
    back += events[i].t < events[i - 1].t ? 1 : 0;
    ahead += events[i].t - events[i - 1].t > kJumpAhead ? 1 : 0;
  }
  const Duration jitter = events.empty() ? Duration(0) : std::chrono::abs(packet.stamp - events.front().t);
  const std::lock_guard lock(mutex_);
  counters_.time_back += back;
  counters_.time_ahead += ahead;
  counters_.stamp_jitter = std::max(counters_.stamp_jitter, jitter);
}

/// Numbers rise by one. If they do not rise, the sender does not count, or has restarted.
void SensorInput::note_number(std::uint64_t number) {
  if (last_number_ && number > *last_number_) {
    const std::uint64_t gap = number - *last_number_ - 1;
    const std::lock_guard lock(mutex_);
    counters_.missed += gap > kMostMissed ? 1 : gap;
  }
  last_number_ = number;
}

InputCounters SensorInput::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace edged::node
