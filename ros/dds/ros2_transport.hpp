// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics of the node in ROS 2.
#pragma once

#include <atomic>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/graph.hpp"
#include "dds/names.hpp"
#include "dds/subscription.hpp"
#include "topics/transport.hpp"

namespace edged::ros2 {

struct TransportSetup {
  Discovery discovery;
  std::optional<Names> names;
  bool reliable = false;      ///< asks for reliable sensor topics: nothing comes from publishers that are best effort
  bool use_sim_time = false;  ///< stamps of our own are those of /clock
  std::string distribution;   ///< "humble"...: the node shows in `ros2 node list`; "": it does not
};

class Ros2Transport final : public node::Transport {
 public:
  /// Throws InputError if the network cannot be had.
  explicit Ros2Transport(const TransportSetup& setup);
  ~Ros2Transport() override { stop(); }

  Wire wire() const override { return Wire::Cdr; }
  Timestamp now() const override;
  std::unique_ptr<node::Publisher> advertise(const node::Advertised& topic) override;
  std::string full_name(const std::string& topic) const override { return names_.full_name(topic); }
  /// Once all topics are subscribed and advertised. Throws InputError as Names.
  void check_remappings() const { names_.check_remappings(); }
  void subscribe(const std::string& topic, Role role, Receive receive) override;
  void subscribe_type(const std::string& topic, const std::string& type, bool latched, Receive receive) override;
  void start() override;
  void stop() override;
  bool ok() const override { return true; }
  std::map<std::string, node::TopicTroubles> troubles() const override;

 private:
  void add_subscription(const std::string& topic, const Qos& qos, std::function<bool(const std::string&)> accepts,
                        Receive receive, bool only_while_published = false);
  void update_graph();
  void note_clock(ByteSpan cdr);

  const Names names_;
  const bool reliable_;
  Participant participant_;
  std::optional<Graph> graph_;
  std::map<std::string, std::shared_ptr<const Writer>> writers_;  ///< by topic
  std::vector<Subscription::Setup> wanted_;                       ///< until start()
  mutable std::mutex mutex_;                                      // of the list, not of what is in it
  std::list<Subscription> subscriptions_;
  std::atomic<bool> clock_runs_ = false;  ///< a message has come
  std::atomic<std::int64_t> clock_ns_ = 0;
  std::optional<Subscription> clock_;   // whose thread sets both
  mutable std::set<std::string> said_;  ///< what is wrong with subscribers
};

}  // namespace edged::ros2
