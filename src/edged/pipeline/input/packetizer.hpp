// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Cuts the measurement stream into packets: events since the last cut, frames if there are some, and the IMU that
// covers them.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "edged/counters.hpp"
#include "edged/measurement.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/event_history.hpp"
#include "edged/pipeline/input/packet.hpp"
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
  std::optional<Packet> next();
  /// The stream has ended: next() gives the remaining packets. Those beyond the last IMU sample are dropped and
  /// counted.
  void finish();

  const PacketizerCounters& counters() const { return counters_; }

 private:
  struct Cut {
    Timestamp t;
    bool by_frame = false;
  };
  struct FrameCamera {
    std::string name;
    Duration offset{0};
    std::optional<Timestamp> newest = {},
                             cut = {};  ///< stamps of the last one received and of the last one in a packet
    std::optional<Timestamp> expected = {};
    Duration period{0};
  };

  void add_events(const EventBatch& batch);
  void add_frame(Frame frame);
  void add_imu(const ImuSample& sample);
  void add_external(const ExternalSample& sample);
  std::vector<ExternalSample> take_external(Timestamp from, Timestamp to);
  void advance_clock(Timestamp recorded, Timestamp complete);
  void start_at(Timestamp t);
  void make_packets(Timestamp complete_until);
  std::optional<Cut> next_cut(Timestamp complete_until) const;
  Timestamp next_event_cut() const;
  Timestamp frames_given_up() const;
  void make_packet(const Cut& cut);
  void take_frames(Packet& packet);
  void drop_overflow();
  void drop_waiting(const std::deque<Packet>::iterator& packet);
  FrameCamera* find_frame_camera(const std::string& name);

  PacketizerConfig config_;
  std::vector<EventHistory> events_;        // one per event camera
  std::vector<FrameCamera> frame_cameras_;  // in the order of the rig
  Duration event_offset_{0};                // of the first event camera
  Duration least_offset_;                   // of all cameras
  Duration frame_patience_{0};              // time that a frame waits for those of other cameras
  PacketizerCounters counters_;

  std::optional<Timestamp> last_recorded_;  // newest stamp of any sensor, as recorded
  Timestamp complete_ = Timestamp::min();   // all sensors have reached this stamp, as recorded

  // On the IMU clock from here on.
  bool started_ = false;  // an event or a frame has been received
  Timestamp last_cut_ = Timestamp::min();
  Timestamp heartbeat_from_ = Timestamp::min();  // last cut, or the end of a gap in the recording

  std::deque<Frame> frames_;    // not cut yet, in the order of their stamps
  std::deque<Packet> waiting_;  // cut, without IMU
  std::size_t waiting_events_ = 0;
  std::vector<ImuSample> imu_;
  std::deque<ExternalSample> external_;  // in the order of their stamps
  std::optional<Timestamp> last_handed_out_;
};

}  // namespace edged
