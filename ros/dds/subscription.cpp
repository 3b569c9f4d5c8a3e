// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/subscription.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "dds/names.hpp"
#include "edged/core/check.hpp"

namespace edged::ros2 {

Subscription::Subscription(const Participant& participant, Setup setup)
    : participant_(participant),
      setup_(std::move(setup)),
      publishers_(dds_create_reader(participant.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                  "discovery"),
      stop_(dds_create_guardcondition(participant.handle()), "guard condition"),
      waitset_(dds_create_waitset(participant.handle()), "waitset") {
  wake_for(publishers_.handle());
  dds_waitset_attach(waitset_.handle(), stop_.handle(), 0);
  thread_ = std::jthread([this](const std::stop_token& stopped) { run(stopped); });
}

void Subscription::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  dds_set_guardcondition(stop_.handle(), true);
  thread_.join();
}

/// Wakes the thread as long as the reader holds messages.
void Subscription::wake_for(dds_entity_t reader) {
  const dds_entity_t condition = dds_create_readcondition(reader, DDS_ANY_STATE);  // deleted with the reader
  dds_waitset_attach(waitset_.handle(), condition, 0);
}

void Subscription::run(const std::stop_token& stopped) {
  try {
    while (!stopped.stop_requested()) {
      dds_waitset_wait(waitset_.handle(), nullptr, 0, DDS_INFINITY);
      discover();
      receive_some();
    }
    drain();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
  }
}

/// Reads what is new of the list of publishers.
void Subscription::discover() {
  constexpr std::size_t kAtOnce = 16;
  std::array<void*, kAtOnce> samples{};
  std::array<dds_sample_info_t, kAtOnce> infos;
  const dds_return_t count = dds_take(publishers_.handle(), samples.data(), infos.data(), kAtOnce, kAtOnce);
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    const auto& publisher = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
    if (infos[i].instance_state != DDS_ALIVE_INSTANCE_STATE) {
      forget_publisher(infos[i].instance_handle);
    } else if (infos[i].valid_data && publisher.topic_name == dds_topic(setup_.topic)) {
      note_publisher(infos[i].instance_handle, publisher.type_name);
    }
  }
  if (count > 0) dds_return_loan(publishers_.handle(), samples.data(), count);
}

void Subscription::forget_publisher(dds_instance_handle_t publisher) {
  std::string type;
  {
    const std::lock_guard lock(mutex_);
    const auto left = present_.find(publisher);
    if (left == present_.end()) return;
    type = left->second;
    present_.erase(left);
    const bool others = std::ranges::any_of(present_, [&type](const auto& one) { return one.second == type; });
    if (others || !setup_.only_while_published) return;
  }
  receive_some();
  const std::lock_guard lock(mutex_);
  readers_.erase(type);
}

void Subscription::note_publisher(dds_instance_handle_t publisher, const std::string& dds_type) {
  const std::string type = ros_type(dds_type);
  {
    const std::lock_guard lock(mutex_);
    present_[publisher] = type.empty() ? dds_type : type;
    if (readers_.contains(type) || !setup_.accepts(type)) return;
    try {
      wake_for(readers_.try_emplace(type, participant_, setup_.topic, type, setup_.qos).first->second.handle());
    } catch (const InputError& error) {
      failure_ = error.what();
      return;
    }
  }
  setup_.on_reader();
}

/// A few messages of each reader; the waitset wakes for the rest.
void Subscription::receive_some() {
  for (auto& [type, reader] : readers_) {  // which only this thread changes
    for (const auto& message : reader.take()) setup_.receive(type, message->cdr());
  }
}

/// What has arrived, and no more than fits a reader: publishers do not stop.
void Subscription::drain() {
  for (auto& [type, reader] : readers_) {
    std::size_t left = setup_.qos.depth;
    for (auto messages = reader.take(); !messages.empty(); messages = reader.take()) {
      for (const auto& message : messages) setup_.receive(type, message->cdr());
      if (messages.size() >= left) break;
      left -= messages.size();
    }
  }
}

std::size_t Subscription::sum(std::size_t (Reader::*count)() const) const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const auto& [type, reader] : readers_) sum += (reader.*count)();
  return sum;
}

std::size_t Subscription::lost() const { return sum(&Reader::lost); }

std::size_t Subscription::refused() const { return sum(&Reader::refused); }

std::string Subscription::trouble() const {
  const std::lock_guard lock(mutex_);
  if (!failure_.empty()) return failure_;
  const auto wrong = std::ranges::find_if(present_, [this](const auto& one) { return !setup_.accepts(one.second); });
  std::size_t accepted = 0;
  for (const auto& [type, reader] : readers_) {
    const auto present = static_cast<std::size_t>(
        std::ranges::count_if(present_, [&name = type](const auto& one) { return one.second == name; }));
    accepted += present;
    // DDS counts those that have left, too.
    const std::string policy = present > reader.writers() ? reader.refused_policy() : "";
    if (policy == "reliability")
      return "a publisher is best effort, and reliable=true asks for more: leave it at false";
    if (!policy.empty())
      return fmt::format("a publisher's QoS does not fit ({}): give it the default QoS of ROS 2", policy);
  }
  if (accepted == 0 && wrong != present_.end())
    return fmt::format("a publisher sends {}, which cannot be used here: remap the topic", wrong->second);
  return "";
}

std::vector<Guid> Subscription::reader_guids() const {
  const std::lock_guard lock(mutex_);
  std::vector<Guid> guids;
  for (const auto& [type, reader] : readers_) guids.push_back(reader.guid());
  return guids;
}

}  // namespace edged::ros2
