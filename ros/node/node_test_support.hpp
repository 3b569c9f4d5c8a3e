// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: a transport that sends nothing anywhere.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "topics/transport.hpp"

namespace edged::node {

/// Keeps what is published, by any threads.
class KeptTransport : public Transport {
 public:
  explicit KeptTransport(Wire wire) : wire_(wire) {}

  Wire wire() const override { return wire_; }
  Timestamp now() const override { return {}; }
  std::unique_ptr<Publisher> advertise(const Advertised& topic) override {
    topics.push_back(topic.name + " " + topic.type);
    if (topic.latched) latched.insert(topic.name);
    return std::make_unique<Kept>(*this, topic.name);
  }
  std::string full_name(const std::string& topic) const override {
    const auto found = remapped.find(topic);
    return found == remapped.end() ? topic : found->second;
  }
  void subscribe(const std::string& topic, Role, Receive receive) override { receivers[topic] = std::move(receive); }
  void subscribe_type(const std::string& topic, const std::string&, bool, Receive receive) override {
    receivers[topic] = std::move(receive);
  }
  void start() override { runs = true; }
  void stop() override { runs = false; }
  bool ok() const override { return true; }
  std::map<std::string, TopicTroubles> troubles() const override { return {}; }

  std::vector<std::string> topics;
  std::map<std::string, std::size_t> counts;  ///< of messages, by topic
  std::set<std::string> latched;              ///< topics
  std::map<std::string, std::string> last;    ///< message of each topic
  std::map<std::string, std::string> remapped;
  std::map<std::string, Receive> receivers;  ///< by topic
  bool runs = false;

 private:
  struct Kept : Publisher {
    Kept(KeptTransport& to, std::string name) : transport(to), topic(std::move(name)) {}
    bool wanted() const override { return true; }
    void publish(const std::string& message) override {
      const std::lock_guard lock(transport.mutex_);
      ++transport.counts[topic];
      transport.last[topic] = message;
    }
    KeptTransport& transport;
    std::string topic;
  };
  Wire wire_;
  std::mutex mutex_;
};

}  // namespace edged::node
