// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Entities of Cyclone DDS with the names, QoS and discovery data that ROS 2 wants.
#pragma once

#include <dds/dds.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dds/environment.hpp"
#include "dds/raw_type.hpp"
#include "edged/time.hpp"

namespace edged::ros2 {

/// Owns a handle of Cyclone.
class Entity {
 public:
  Entity() = default;
  /// what: for the message of the InputError that a handle throws that is an error.
  Entity(dds_entity_t handle, const std::string& what);
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }

  dds_entity_t handle() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

/// What a reader wants or a writer offers; ROS 2 knows more, which nobody needs here.
struct Qos {
  bool reliable = true;
  bool latched = false;    ///< transient local: a late reader gets the last `depth` messages
  std::size_t depth = 10;  ///< a reader refuses and counts messages beyond it, and overwrites none
  /// A reliable writer waits this long for readers that do not keep up before it drops a message; 0: it
  /// overwrites the oldest one beyond `depth`, uncounted.
  Duration longest_block{0};

  friend bool operator==(const Qos&, const Qos&) = default;
};

using Guid = std::vector<std::uint8_t>;  ///< 16 bytes

/// One process in a domain. The first one of a process configures the domain for all.
class Participant {
 public:
  /// Throws InputError if the network cannot be had.
  explicit Participant(const Discovery& discovery);

  dds_entity_t handle() const { return participant_.handle(); }
  Guid guid() const;

 private:
  Entity domain_, participant_;  // destroyed in the reverse order
};

/// type: "sensor_msgs/Imu". Serialised messages with their header of four bytes.
class Writer {
 public:
  Writer(const Participant& participant, const std::string& topic, std::string_view type, const Qos& qos);

  /// False when it had to be dropped: reliable readers did not keep up for `longest_block`. From any thread.
  bool write(std::string_view cdr) const;
  std::size_t readers() const;
  /// The policy that a reader asks for and that is not offered; "" if there is none.
  std::string refused_policy() const;
  /// Until all reliable readers have received everything, or the time is over.
  void flush(Duration longest) const;
  Guid guid() const;
  dds_entity_t handle() const { return writer_.handle(); }

 private:
  const ddsi_sertype* type_ = nullptr;  // belongs to the topic
  Entity topic_, writer_;
};

/// One thread takes; the rest may be called from any.
class Reader {
 public:
  Reader(const Participant& participant, const std::string& topic, std::string_view type, const Qos& qos);

  /// The oldest messages, a few at a time; none if there are none.
  std::vector<std::unique_ptr<RawMessage>> take();
  std::size_t writers() const;
  /// Messages that the network lost. Of a best-effort reader DDS does not count them: their numbers are missing.
  std::size_t lost() const;
  /// Messages that came when `depth` others waited.
  std::size_t refused() const;
  /// The policy that a writer does not offer, so that its messages do not come; "" if there is none.
  std::string refused_policy() const;
  Guid guid() const;
  dds_entity_t handle() const { return reader_.handle(); }

 private:
  void note(const Origin& origin);

  bool reliable_;
  Entity topic_, reader_;
  std::map<std::array<std::uint8_t, 16>, std::uint64_t> newest_;  // number that was taken, by writer
  std::atomic<std::size_t> missing_ = 0;                          // numbers
};

Guid guid_of(dds_entity_t entity);

}  // namespace edged::ros2
