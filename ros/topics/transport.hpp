// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the node needs of ROS 1 or ROS 2: topics whose messages are bytes.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "edged/io/core/topic_choice.hpp"
#include "edged/io/ros/messages/wire.hpp"
#include "edged/time.hpp"

namespace edged::node {

/// A serialised message.
struct WireMessage {
  std::string type;  ///< "sensor_msgs/Imu", also of ROS 2
  std::string md5;   ///< sum of its definition, in ROS 1 only
  ByteSpan bytes;
};

/// A topic that the node publishes. Names as in ROS: "/tf" is absolute, "image" is in the namespace of the
/// node, "~/odometry" is its own.
struct Advertised {
  std::string name, type;
  std::size_t depth = 10;  ///< messages that may wait for a slow subscriber
  bool latched = false;    ///< a late subscriber gets the last `depth` messages
  bool reliable = true;    ///< in ROS 2: what a subscriber misses is sent again
};

/// From one thread at a time.
class Publisher {
 public:
  virtual ~Publisher() = default;
  /// Whether there is a subscriber.
  virtual bool wanted() const = 0;
  virtual void publish(const std::string& message) = 0;
};

/// What went wrong with a topic on its way.
struct TopicTroubles {
  std::size_t lost = 0;     ///< messages that the transport knows to be lost on the way
  std::size_t refused = 0;  ///< messages that came when as many as may waited
  std::string trouble;      ///< why nothing can come, with the remedy; "" otherwise
};

class Transport {
 public:
  using Receive = std::function<void(const WireMessage&)>;

  virtual ~Transport() = default;
  virtual Wire wire() const = 0;
  /// The clock of stamps that no sensor gives.
  virtual Timestamp now() const = 0;
  virtual std::unique_ptr<Publisher> advertise(const Advertised& topic) = 0;
  /// With namespace and remapping.
  virtual std::string full_name(const std::string& topic) const = 0;
  /// Messages of the topic, a full name, arrive one by one, in order, but those of other topics in other threads; from
  /// start() to the end of stop(), which delivers what has arrived. Any type is accepted that the role can have.
  /// `receive` does not throw.
  virtual void subscribe(const std::string& topic, Role role, Receive receive) = 0;
  /// A topic, a full name, of that type alone. latched: a late subscriber gets its last messages, too.
  virtual void subscribe_type(const std::string& topic, const std::string& type, bool latched, Receive receive) = 0;
  virtual void start() = 0;
  virtual void stop() = 0;  ///< also if start() has failed or was not called; again without effect
  /// False once ROS itself shuts the node down.
  virtual bool ok() const = 0;
  /// Troubles of the subscribed topics, by full name.
  virtual std::map<std::string, TopicTroubles> troubles() const = 0;
};

}  // namespace edged::node
