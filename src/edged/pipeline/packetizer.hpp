// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Cuts the measurement stream into packets: events since the last cut, an optional frame, and the IMU that covers them.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/counters.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/rig.hpp"

namespace edged {

/// One step of the odometry. All stamps are on the IMU clock: camera time offsets are applied here, once, to events
/// and frames alike.
struct Packet {
  Timestamp t;                 ///< reference time, the instant of the cut: the frame's stamp, the stamp of the event
                               ///< that completed the count, or where a time limit fell
  std::vector<Event> events;   ///< oldest first, all t <= packet t; overlaps the previous packet's (augmented packet)
  std::size_t new_events = 0;  ///< how many of them came since the previous packet (at the end of `events`)
  std::size_t window_events = 0;  ///< how many to draw (at the end of `events`)
  std::optional<Frame> frame;     ///< set when a frame cut the packet; its stamp is t
  std::vector<ImuSample> imu;     ///< from the previous packet's t (or the first sample) to t, both ends interpolated
  double event_rate_hz = 0.0;     ///< new events over the time since the previous cut, at least 1 ms

  /// The events of the event frame: the newest window_per_pixel * pixels, none older than max_age_s.
  std::span<const Event> window() const { return std::span<const Event>(events).last(window_events); }
};

/// Frames cut packets always. Events cut one when there are enough of them, or after the longest time; these cuts keep
/// min_interval_s from the last cut and give way to a frame that is there or, by the frame period, due within
/// min_interval_s. In Frames mode, when frames stay away, a packet without one is cut every 5 s: the IMU samples do not
/// pile up, and whoever reads the steps learns that nothing is seen.
///
/// Single-threaded and deterministic. Memory is bounded by the window, the delay of the IMU and, in Frames mode, the
/// IMU samples of 5 s. Before the first packet 20 to 40 s of IMU are kept.
class Packetizer {
 public:
  /// Uses the rig's first event camera (Events, Fused) and first frame camera (Frames, Fused); InputError when it lacks
  /// one or the intervals contradict each other. Counts on from so_far.
  Packetizer(const Rig& rig, Mode mode, const PacketizerConfig& config, const PacketizerCounters& so_far = {});

  /// The next measurement of a Dataset: in the order of the recorded stamps, each on its own clock.
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

  void add_events(const EventBatch& batch);
  void add_frame(Frame frame);
  void add_imu(const ImuSample& sample);
  void advance_clock(Timestamp recorded, bool is_frame);
  void start_at(Timestamp t);
  void make_packets(Timestamp complete_until);
  std::optional<Cut> next_cut(Timestamp complete_until) const;
  Timestamp next_event_cut() const;
  Timestamp frames_given_up() const;
  void make_packet(const Cut& cut);
  void take_events(Packet& packet);
  void drop_overflow();
  void drop_waiting(const std::deque<Packet>::iterator& packet);

  Mode mode_;
  PacketizerConfig config_;
  std::string event_camera_, frame_camera_;  // empty: not used in this mode
  Duration event_offset_{0}, frame_offset_{0};
  std::size_t cut_events_ = 0, window_events_ = 0;  // per packet
  PacketizerCounters counters_;

  // On the IMU clock from here on.
  bool started_ = false;  // an event or a frame has come
  Timestamp last_cut_ = Timestamp::min();
  Timestamp heartbeat_from_ = Timestamp::min();   // last cut, or the end of a hole in the recording
  std::optional<Timestamp> last_recorded_;        // newest stamp of any sensor, as recorded
  Timestamp events_complete_ = Timestamp::min();  // all events up to here have come
  Timestamp frames_complete_ = Timestamp::min();
  std::optional<Timestamp> last_frame_;
  std::optional<Timestamp> expected_frame_;
  Duration frame_period_{0};

  std::vector<Event> events_;  // history, then the uncut ones
  std::size_t history_begin_ = 0, uncut_begin_ = 0;
  std::deque<Frame> frames_;    // not cut yet
  std::deque<Packet> waiting_;  // cut, without IMU
  std::size_t waiting_events_ = 0;
  std::vector<ImuSample> imu_;
  std::optional<Timestamp> last_handed_out_;
};

}  // namespace edged
