// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/ros2_transport.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "edged/io/ros/messages/messages.hpp"

namespace edged::ros2 {
namespace {

// Messages that may wait for the decoder. Drivers send event packets and IMU samples a thousand times a second.
constexpr std::size_t kSamples = 1000, kFrames = 60;

class DdsPublisher final : public node::Publisher {
 public:
  explicit DdsPublisher(std::shared_ptr<const Writer> writer) : writer_(std::move(writer)) {}
  bool wanted() const override { return writer_->readers() > 0; }
  void publish(const std::string& message) override { writer_->write(message); }

 private:
  std::shared_ptr<const Writer> writer_;
};

}  // namespace

Ros2Transport::Ros2Transport(const TransportSetup& setup)
    : names_(setup.names.value()), reliable_(setup.reliable), participant_(setup.discovery) {
  if (!setup.distribution.empty())
    graph_.emplace(participant_, gid_bytes_of(setup.distribution), names_.name_space(), names_.node());
  if (const auto bytes = small_receive_buffer())
    spdlog::warn(
        fmt::format("net.core.rmem_max is {} kB: messages of 64 kB and more will be lost at high rates; "
                    "`sudo sysctl -w net.core.rmem_max=8388608`",
                    *bytes / 1024));
  if (!setup.use_sim_time) return;
  Subscription::Setup clock{names_.full_name("/clock"), {.reliable = false}};
  clock.accepts = [](const std::string& type) { return type == "rosgraph_msgs/Clock"; };
  clock.receive = [this](const std::string&, ByteSpan cdr) { note_clock(cdr); };
  clock_.emplace(participant_, std::move(clock));
}

void Ros2Transport::note_clock(ByteSpan cdr) {
  try {
    clock_ns_ = to_ns(WireReader(Wire::Cdr, cdr).time());
    clock_runs_ = true;
  } catch (const Damage&) {  // the next one will do
  }
}

Timestamp Ros2Transport::now() const {
  if (clock_) return timestamp_from_ns(clock_ns_);
  return timestamp_from_ns(
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count());
}

std::unique_ptr<node::Publisher> Ros2Transport::advertise(const node::Advertised& topic) {
  const std::string name = full_name(topic.name);
  const Qos qos{.reliable = topic.reliable, .latched = topic.latched, .depth = topic.depth};
  auto writer = std::make_shared<const Writer>(participant_, name, topic.type, qos);
  writers_[name] = writer;
  return std::make_unique<DdsPublisher>(std::move(writer));
}

void Ros2Transport::subscribe(const std::string& topic, Role role, Receive receive) {
  const Qos qos{.reliable = reliable_, .depth = role == Role::Frames ? kFrames : kSamples};
  add_subscription(
      topic, qos, [role](const std::string& type) { return can_take(type, role); }, std::move(receive));
}

void Ros2Transport::subscribe_type(const std::string& topic, const std::string& wanted, bool latched, Receive receive) {
  const Qos qos{.latched = latched, .depth = kSamples};
  add_subscription(
      topic, qos, [wanted](const std::string& type) { return type == wanted; }, std::move(receive), !latched);
}

void Ros2Transport::add_subscription(const std::string& topic, const Qos& qos,
                                     std::function<bool(const std::string&)> accepts, Receive receive,
                                     bool only_while_published) {
  wanted_.push_back({topic, qos, std::move(accepts),
                     [receive = std::move(receive)](const std::string& type, ByteSpan cdr) {
                       receive({type, "", cdr});
                     },
                     [this] { update_graph(); }, only_while_published});
}

void Ros2Transport::start() {
  {
    const std::lock_guard lock(mutex_);
    for (Subscription::Setup& setup : wanted_) subscriptions_.emplace_back(participant_, std::move(setup));
    wanted_.clear();
  }
  update_graph();
}

void Ros2Transport::stop() {
  for (Subscription& subscription : subscriptions_) subscription.stop();
  if (clock_) clock_->stop();
}

void Ros2Transport::update_graph() {
  if (!graph_) return;
  const std::lock_guard lock(mutex_);
  std::vector<Guid> readers, writers;
  for (const auto& [topic, writer] : writers_) writers.push_back(writer->guid());
  for (const Subscription& subscription : subscriptions_)
    for (Guid& guid : subscription.reader_guids()) readers.push_back(std::move(guid));
  graph_->update(readers, writers);
}

std::map<std::string, node::TopicTroubles> Ros2Transport::troubles() const {
  for (const auto& [topic, writer] : writers_) {
    const std::string policy = writer->refused_policy();
    if (!policy.empty() && said_.insert(topic).second)
      spdlog::warn(
          fmt::format("{}: a subscriber receives nothing, as its QoS requests more than is offered ({}): give it the "
                      "default QoS of ROS 2",
                      topic, policy));
  }
  std::map<std::string, node::TopicTroubles> troubles;
  for (const Subscription& subscription : subscriptions_)
    troubles[subscription.topic()] = {subscription.lost(), subscription.refused(), subscription.trouble()};
  if (clock_ && !clock_runs_) {
    const std::string trouble = clock_->trouble();
    troubles[clock_->topic()].trouble =
        trouble.empty() ? "nothing was received: start the simulator, or leave use_sim_time out" : trouble;
  }
  return troubles;
}

}  // namespace edged::ros2
