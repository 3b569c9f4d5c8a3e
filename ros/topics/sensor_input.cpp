// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "topics/sensor_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "edged/io/ros/messages/messages.hpp"

namespace edged::node {
namespace {

constexpr Duration kJumpAhead = std::chrono::seconds(1);
constexpr std::uint64_t kMostMissed = 1'000'000;                        // a larger gap is a new way of counting
constexpr Duration kShortestInterval = std::chrono::microseconds(100);  // no IMU is faster
constexpr std::size_t kIntervals = 100;                                 // that tell the rate of an IMU
constexpr double kGap = 1.8;  // intervals between two stamps with a missing one between them
constexpr Duration kLongestGap = std::chrono::seconds(1);  // a longer one is a driver that was stopped

bool is_packet(std::string_view type) { return type == "event_camera_msgs/EventPacket"; }

/// Their median; nothing if they are those of arrival, when several samples come at once.
std::optional<Duration> usual_interval(const std::deque<Duration>& intervals) {
  std::vector<Duration> sorted(intervals.begin(), intervals.end());
  std::ranges::sort(sorted);
  const Duration median = sorted[sorted.size() / 2];
  const double shortest = to_seconds(sorted[sorted.size() / 10]) / to_seconds(median),
               longest = to_seconds(sorted[sorted.size() * 3 / 4]) / to_seconds(median);
  const bool regular = median > kShortestInterval && shortest > 0.5 && longest < kGap;
  return regular ? std::optional(median) : std::nullopt;
}

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
    counters_.left_out = decoder_.left_out();
    counters_.clock_steps = decoder_.clock().steps();
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
  if (jitter < SensorClock::kStep) counters_.stamp_jitter = std::max(counters_.stamp_jitter, jitter);
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

/// Samples of ROS 2 have no number, but a rate.
void SensorInput::note_time(Timestamp stamp) {
  if (role_ != Role::Imu || wire_ != Wire::Cdr) return;
  const Duration interval = last_stamp_ ? stamp - *last_stamp_ : Duration(0);
  last_stamp_ = stamp;
  if (interval <= Duration(0) || interval > kLongestGap) return;
  if (intervals_.size() == kIntervals) {
    const std::optional<Duration> usual = usual_interval(intervals_);
    const double ratio = usual ? to_seconds(interval) / to_seconds(*usual) : 0.0;
    if (ratio > kGap) {
      const std::lock_guard lock(mutex_);
      counters_.missed += static_cast<std::size_t>(std::lround(ratio)) - 1;
    }
    intervals_.pop_front();
  }
  intervals_.push_back(interval);
}

InputCounters SensorInput::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace edged::node
