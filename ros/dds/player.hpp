// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording as topics of ROS 2, as drivers send them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "dds/names.hpp"
#include "dds/participant.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "topics/period.hpp"

namespace edged::ros2 {

struct PlaySetup {
  Discovery discovery;
  std::optional<Names> names;
  double rate = 1.0;         ///< seconds of the recording per second
  bool best_effort = false;  ///< what most drivers offer; otherwise subscribers that ask for it get all
};

struct PlayCounters {
  std::size_t events = 0, messages = 0;
  std::size_t dropped = 0;  ///< messages, as reliable subscribers did not keep up
};

/// Topics `events`, `image` (of a second camera NAME: `NAME/events`, `NAME/image`), `imu`, `height` and `velocity`,
/// which are those that the node subscribes to, and /clock. Stamps are those of the recording.
class Player {
 public:
  /// Throws InputError if the network cannot be had, or the size of an event sensor is unknown.
  Player(const PlaySetup& setup, WriterSetup recording);

  /// The topic that nobody subscribes to yet: that of the IMU, or any one if the recording has none. Empty if somebody
  /// does.
  std::string unsubscribed() const;
  /// At the rate of the setup, until the end or `stop`. progress: the stamp that has been sent. Throws InputError for
  /// stamps that ROS cannot hold.
  PlayCounters play(Dataset& dataset, const std::function<bool()>& stop,
                    const std::function<void(Timestamp)>& progress);

 private:
  /// What the packets of an event camera have in common.
  struct EventStream {
    cv::Size sensor;
    std::string encoding;  ///< "evt3" (microseconds), or "mono" for finer stamps; as the first packet needs
    std::uint64_t sequence = 0;
  };

  void add_topic(const std::string& topic, std::string_view type);
  void send(const std::string& topic, const std::string& message);
  void send(const Measurement& measurement, const std::function<bool()>& stop);
  void send(const EventBatch& batch, const std::function<bool()>& stop);
  void send_packet(EventStream& stream, const std::string& topic, const std::string& camera,
                   std::span<const Event> events);
  void send_clock(Timestamp t);
  void check_stamp(Timestamp t) const;
  void flush() const;
  std::string camera_topic(std::size_t place, Modality modality) const;

  const PlaySetup setup_;
  const WriterSetup recording_;
  Participant participant_;
  std::map<std::string, Writer> writers_;       ///< by the name before remapping
  std::map<std::string, EventStream> streams_;  ///< by topic
  node::Period clock_;                          ///< between its messages
  PlayCounters counters_;
};

}  // namespace edged::ros2
