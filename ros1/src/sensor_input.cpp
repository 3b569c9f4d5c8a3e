// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "sensor_input.hpp"

#include <fmt/format.h>

#include "edged/io/ros/definitions.hpp"
#include "edged/io/ros/messages.hpp"

namespace edged::ros1 {

std::optional<Measurement> SensorInput::read(const WireMessage& message) {
  std::optional<Measurement> measurement;
  std::string trouble;
  try {
    note_number(ByteReader(message.bytes).number<std::uint32_t>());  // every header begins with it
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
  const std::string_view md5 = ros1_md5_of(message.type);
  if (!md5.empty() && md5 != message.md5)
    throw Damage(fmt::format("of another version: md5 {}, not {}", message.md5, md5));
  const WireReader reader(Wire::Ros1, message.bytes);
  switch (role_) {
    case Role::Events:
      return EventBatch{camera_, decoder_.decode(message.type, reader).events};
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

/// Numbers rise by one. If they do not rise, the sender does not count, or has restarted.
void SensorInput::note_number(std::uint32_t number) {
  if (last_number_ && number > *last_number_) {
    const std::lock_guard lock(mutex_);
    counters_.missed += number - *last_number_ - 1;
  }
  last_number_ = number;
}

InputCounters SensorInput::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace edged::ros1
