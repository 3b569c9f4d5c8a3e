// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Cuts the measurement stream into packets: events since the last cut, frames if there are some, and the IMU that
// covers them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "edged/counters.hpp"
#include "edged/measurement.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/event_history.hpp"
#include "edged/pipeline/input/frame_queue.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/pipeline/input/packet_completion.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Frames cut packets always, those of several cameras within 1 ms, as of a synchronised pair, one together. Events cut
/// one when there are enough of them of any camera, or after the longest time; these cuts are at least min_interval_s
/// after the last cut and yield to a frame that is present or, by the period of its camera, due within min_interval_s.
/// Without event cameras, when no frames arrive, a packet without one is cut every 5 s: IMU samples do not accumulate,
/// and the steps report that vision is lost.
///
/// Samples of external sensors never cut: each goes into the packet of its time if it arrives before that is returned,
/// and the packets are otherwise the same without them.
///
/// Single-threaded and deterministic. Memory is bounded by the windows, the delay of the IMU and, without event
/// cameras, the IMU samples of 5 s. Before the first packet 20 to 40 s of IMU are kept.
class Packetizer {
 public:
  /// cameras: those of the run. Throws InputError when the intervals contradict each other. Counters continue from
  /// so_far.
  Packetizer(const Rig& cameras, const PacketizerConfig& config, const PacketizerCounters& so_far = {});

  /// The next measurement of a Dataset: in the order of the recorded stamps, each on its own clock; batches of two
  /// event cameras by their first events.
  void add(Measurement measurement);
  /// The next packet whose IMU is complete, if there is one. Call until it returns nothing after each add.
  std::optional<Packet> next() { return completion_.next(counters_); }
  /// The stream has ended: next() gives the remaining packets. Those beyond the last IMU sample are dropped and
  /// counted.
  void finish();

  const PacketizerCounters& counters() const { return counters_; }

 private:
  void add_events(const EventBatch& batch);
  void add_frame(Frame frame);
  void advance_clock(Timestamp recorded, Timestamp complete);
  void start_at(Timestamp t);
  void make_packets(Timestamp complete_until);
  Timestamp next_cut_without_frame() const;
  void make_packet(Timestamp t, bool by_frame);

  PacketizerConfig config_;
  std::vector<EventHistory> events_;  // one per event camera
  FrameQueue frames_;                 // not cut yet
  PacketCompletion completion_;       // of those that are
  PacketizerCounters counters_;
  Duration event_offset_{0};  // of the first event camera
  Duration least_offset_;     // of all cameras

  std::optional<Timestamp> last_recorded_;  // newest stamp of any sensor, as recorded
  Timestamp complete_ = Timestamp::min();   // all sensors have reached this stamp, as recorded

  // On the IMU clock.
  bool started_ = false;  // an event or a frame has been received
  Timestamp last_cut_ = Timestamp::min();
  Timestamp heartbeat_from_ = Timestamp::min();  // last cut, or the end of a gap in the recording
};

}  // namespace edged
