// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Completes packets that have been cut by the IMU samples and external samples of their time.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "edged/counters.hpp"
#include "edged/imu/imu_gate.hpp"
#include "edged/measurement.hpp"
#include "edged/pipeline/input/packet.hpp"

namespace edged {

/// Memory is bounded; all that is dropped is counted.
class PacketCompletion {
 public:
  /// max_events: in packets that wait. Beyond it the oldest packets lose their events, those without a frame
  /// are dropped. IMU counts continue from so_far.
  PacketCompletion(int max_events, const ImuFaultCounts& so_far)
      : max_events_(static_cast<std::size_t>(max_events)), gate_(so_far) {}

  /// Adds a packet that has been cut. Packets come in the order of time.
  void add(Packet packet, PacketizerCounters& counters);
  void add(const ImuSample& sample, PacketizerCounters& counters);
  void add(const ExternalSample& sample, PacketizerCounters& counters);
  /// The next packet whose IMU is complete, if there is one.
  std::optional<Packet> next(PacketizerCounters& counters);
  /// The stream has ended: drops the packets beyond the last IMU sample, and the external samples beyond the last
  /// packet.
  void finish(PacketizerCounters& counters);

 private:
  std::vector<ExternalSample> take_external(Timestamp from, Timestamp to, PacketizerCounters& counters);
  void drop_events(Packet& packet, PacketizerCounters& counters);
  void drop(const std::deque<Packet>::iterator& packet, PacketizerCounters& counters);

  std::size_t max_events_;
  std::deque<Packet> waiting_;
  std::size_t waiting_events_ = 0;
  ImuGate gate_;
  std::vector<ImuSample> imu_;           // that passed it
  std::deque<ExternalSample> external_;  // in the order of their stamps
  std::optional<Timestamp> last_handed_out_;
};

}  // namespace edged
