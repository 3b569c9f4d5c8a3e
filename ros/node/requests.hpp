// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is asked of a running node, by topics: to save or load the map, to start anew.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "topics/transport.hpp"

namespace edged::node {

struct Request {
  enum class Kind { SaveMap, LoadMap, Reset };
  Kind kind;
  std::string file;  ///< "" for a reset

  std::string text() const;  ///< "save_map /tmp/lab.map"
};

/// Topics, as services of the implementations of ROS 2 differ on the wire: Fast DDS names the request in the inline QoS
/// of the reply, Cyclone DDS in its bytes.
class Requests {
 public:
  /// Subscribes.
  explicit Requests(Transport& transport);

  /// The oldest one that has not been taken; from any thread.
  std::optional<Request> next();

 private:
  void subscribe(Transport& transport, const std::string& topic, const std::string& type, Request::Kind kind);
  void add(Request::Kind kind, Wire wire, ByteSpan message);

  std::mutex mutex_;
  std::deque<Request> waiting_;
};

/// The bytes of a saved map. Throws InputError if the file cannot be read.
std::string read_map_file(const std::string& file);
/// Replaces the file at once, or leaves it. Throws InputError for a file that is no map, and where it cannot be
/// written.
void write_map_file(const std::string& file, const std::string& bytes);

}  // namespace edged::node
