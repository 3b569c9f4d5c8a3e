// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Serialised messages of one topic into measurements, by the decoders that read bags.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/core/topic_choice.hpp"
#include "edged/io/ros/messages/event_packets.hpp"
#include "edged/measurement.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// The counters of one topic.
struct InputCounters {
  bool optional = false;  ///< a sensor that no mode needs
  std::size_t messages = 0;
  std::size_t events = 0;              ///< in them
  std::size_t unreadable = 0;          ///< dropped messages: damaged, or of a wrong type
  std::size_t missed = 0;              ///< messages that never came: gaps in their numbers, or in the stamps of the IMU
  std::size_t lost = 0;                ///< messages that the transport knows to be lost on the way
  std::size_t refused = 0;             ///< messages that came when as many as may waited
  std::size_t left_out = 0;            ///< events without time or place, as the packet before them is missing
  std::size_t time_back = 0;           ///< steps of the time back within a message
  std::size_t time_ahead = 0;          ///< jumps of the time ahead within a message
  Duration stamp_jitter{0};            ///< largest deviation of a packet's stamp from the clock of the sensor
  std::vector<ClockStep> clock_steps;  ///< of the two
  std::string trouble;                 ///< with the last unreadable one
  std::string transport_trouble;       ///< why nothing can come
};

/// "imu", or "events of davis".
std::string sensor_text(Role role, const std::string& camera);

class SensorInput {
 public:
  /// camera: whose events or frames come; of no meaning for the other sensors.
  SensorInput(Wire wire, Role role, std::string camera) : wire_(wire), role_(role), camera_(std::move(camera)) {
    counters_.optional = external_sensor_of(role) != nullptr;
  }

  /// The measurements of the message; nothing, and counted, if it is unreadable. One thread at a time.
  std::optional<Measurement> read(const WireMessage& message);
  /// The time of each measurement in order, by which samples of the IMU are missing. One thread at a time.
  void note_time(Timestamp t);
  /// The clock of the sensor, if its packets have it; only in the thread of read().
  const SensorClock* clock() const { return decoder_.clock().known() ? &decoder_.clock() : nullptr; }
  std::string sensor() const { return sensor_text(role_, camera_); }
  /// From any thread.
  InputCounters counters() const;

 private:
  Measurement decode(const WireMessage& message);
  EventBatch decode_events(const WireMessage& message);
  void note_packet(const EventPacket& packet, const std::vector<Event>& events);
  void note_number(std::uint64_t number);

  const Wire wire_;
  const Role role_;
  const std::string camera_;
  EventMessageDecoder decoder_;
  std::optional<std::uint64_t> last_number_;
  std::optional<Timestamp> last_stamp_;  ///< newest stamp of the IMU
  std::deque<Duration> intervals_;       ///< the newest ones between stamps of the IMU
  mutable std::mutex mutex_;             // of what is below
  InputCounters counters_;
};

}  // namespace edged::node
