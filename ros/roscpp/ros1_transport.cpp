// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "roscpp/ros1_transport.hpp"

#include <ros/serialization.h>

#include "edged/io/ros/messages/wire.hpp"

namespace edged::ros1 {
namespace {

constexpr std::uint32_t kNoLimit = 0;  // excess measurements are dropped and counted by the node
constexpr unsigned kThreads = 3;       // one for each sensor that every rig has

using AnyMessage = topic_tools::ShapeShifter;

class Ros1Publisher final : public node::Publisher {
 public:
  Ros1Publisher(ros::NodeHandle& node, const std::string& name, const node::Advertised& topic) {
    const MessageDefinition definition = definition_of(topic.type, Wire::Ros1);
    message_.morph(definition.md5, topic.type, definition.text, topic.latched ? "1" : "");
    publisher_ = message_.advertise(node, name, static_cast<std::uint32_t>(topic.depth), topic.latched);
  }
  bool wanted() const override { return publisher_.getNumSubscribers() > 0; }
  void publish(const std::string& message) override {
    // The library wants mutable bytes, but only reads.
    auto* const bytes = reinterpret_cast<std::uint8_t*>(const_cast<char*>(message.data()));
    ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(message.size()));
    message_.read(stream);
    publisher_.publish(message_);
  }

 private:
  AnyMessage message_;
  ros::Publisher publisher_;
};

Bytes bytes_of(const AnyMessage& message) {
  Bytes bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), message.size());
  message.write(stream);
  return bytes;
}

}  // namespace

Ros1Transport::Ros1Transport() : private_("~"), spinner_(kThreads) {}

Timestamp Ros1Transport::now() const { return timestamp_from_ns(static_cast<std::int64_t>(ros::Time::now().toNSec())); }

std::unique_ptr<node::Publisher> Ros1Transport::advertise(const node::Advertised& topic) {
  const bool own = topic.name.starts_with("~/");
  return std::make_unique<Ros1Publisher>(own ? private_ : public_, own ? topic.name.substr(2) : topic.name, topic);
}

/// The message has its type.
void Ros1Transport::subscribe(const std::string& topic, Role /*role*/, Receive receive) {
  const auto callback = [receive = std::move(receive)](const AnyMessage::ConstPtr& message) {
    const Bytes bytes = bytes_of(*message);
    receive({message->getDataType(), message->getMD5Sum(), bytes});
  };
  subscriptions_.push_back(
      public_.subscribe<AnyMessage>(topic, kNoLimit, callback, nullptr, ros::TransportHints().tcpNoDelay()));
}

}  // namespace edged::ros1
