// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Stamps that go on when the clock that gives them is set.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edged/io/ros/messages/event_packets.hpp"
#include "edged/measurement.hpp"

namespace edged::node {

/// The clock of a computer is set while it runs, by NTP after its start, that of an event camera is not: its packets
/// have both, and tell a step from a gap. Measurements of all topics stay on the clock as it was at first. While such
/// packets come, a measurement whose stamp jumps is held until their stamps have come as far. From any thread.
class StampClock {
 public:
  using Clock = std::chrono::steady_clock;
  struct Passed {
    std::string topic;
    Measurement measurement;
  };

  /// What can be passed on with that measurement, of other topics, too. sensor: the clock of an event camera.
  std::vector<Passed> pass(const std::string& topic, Measurement measurement, const SensorClock* sensor,
                           Clock::time_point now);
  /// By how much the clock has been set since the start: what a time of ours lacks to be one of its stamps.
  Duration set_by() const;

 private:
  struct Topic {
    std::optional<Timestamp> last;  ///< stamp
    Duration interval{0};           ///< the usual one
    Duration set_by{0};
    std::size_t own_steps = 0, steps = 0;  ///< of its sensor's clock, and of those below, that it has followed
    std::vector<Measurement> held;
    Duration jump{0};      ///< of the first one of these
    Timestamp decided_at;  ///< stamp of event packets from which on these tell that it was a gap
  };
  bool jumps(Topic& topic, Timestamp stamp, Clock::time_point now);
  void follow(Topic& topic, const std::vector<ClockStep>& steps);
  bool decide(Topic& topic, Clock::time_point now) const;
  std::optional<std::size_t> step_of(const Topic& topic, Duration jump) const;

  mutable std::mutex mutex_;
  std::map<std::string, Topic> topics_;
  std::vector<Duration> steps_;         ///< of the clock of the stamps
  Clock::time_point packet_at_;         ///< arrival of the newest packet of events
  std::optional<Timestamp> undoubted_;  ///< latest stamp of those with both clocks where they should be
};

}  // namespace edged::node
