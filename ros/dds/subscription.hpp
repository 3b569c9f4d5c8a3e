// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One topic of ROS 2, of whatever type its publisher has.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "dds/participant.hpp"

namespace edged::ros2 {

/// In DDS a reader has a type. Discovery tells those of the publishers; a reader is made for each that is accepted.
/// Messages arrive in a thread of this object, from the constructor to the end of stop().
class Subscription {
 public:
  struct Setup {
    std::string topic;
    Qos qos = {};
    std::function<bool(const std::string& type)> accepts = {};  ///< "sensor_msgs/Imu"
    std::function<void(const std::string& type, ByteSpan cdr)> receive = {};
    std::function<void()> on_reader = [] {};  ///< called when a reader has been made
    /// A reader goes with the last publisher of its type. Only who is known here finds the next one: a publisher of a
    /// single message sends it as soon as it finds a reader, and one that does not know it yet would lose it.
    bool only_while_published = false;
  };
  Subscription(const Participant& participant, Setup setup);
  ~Subscription() { stop(); }
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

  /// What has arrived is received yet.
  void stop();

  // From any thread:
  const std::string& topic() const { return setup_.topic; }
  std::size_t lost() const;
  std::size_t refused() const;
  /// Why nothing can come, with the remedy; "" if nothing speaks against it.
  std::string trouble() const;
  std::vector<Guid> reader_guids() const;

 private:
  void run(const std::stop_token& stopped);
  void discover();
  void note_publisher(dds_instance_handle_t publisher, const std::string& dds_type);
  void forget_publisher(dds_instance_handle_t publisher);
  void wake_for(dds_entity_t reader);
  std::size_t sum(std::size_t (Reader::*count)() const) const;
  void receive_some();
  void drain();

  const Participant& participant_;
  const Setup setup_;
  Entity publishers_, stop_, waitset_;
  mutable std::mutex mutex_;                              // of what is below
  std::map<std::string, Reader> readers_;                 // by type
  std::map<dds_instance_handle_t, std::string> present_;  // publishers that there are now: their types
  std::string failure_;                                   // of the thread, or of the making of a reader
  std::jthread thread_;
};

}  // namespace edged::ros2
