// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: a domain of this process, and readers and writers that know the types of messages.idl.
#pragma once

#include <dds/dds.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "dds/names.hpp"
#include "dds/participant.hpp"

namespace edged::ros2 {

/// A domain of this process, on this machine only.
inline Discovery test_discovery() {
  Discovery discovery;
  discovery.domain = 1 + static_cast<std::uint32_t>(getpid()) % 100;
  discovery.range = DiscoveryRange::Localhost;
  return discovery;
}

inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::seconds longest = std::chrono::seconds(10)) {
  const auto end = std::chrono::steady_clock::now() + longest;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// Another participant, whose endpoint Cyclone itself encodes or decodes. T: a struct that idlc made.
template <typename T>
class TypedPeer {
 public:
  TypedPeer(const std::string& topic, const dds_topic_descriptor_t& type, dds_qos_t* qos = nullptr)
      : participant_(dds_create_participant(test_discovery().domain, nullptr, nullptr), "participant"),
        topic_(dds_create_topic(participant_.handle(), &type, dds_topic(topic).c_str(), nullptr, nullptr), topic),
        qos_(qos ? qos : default_qos(), &dds_delete_qos) {}

  void read() {
    endpoint_ = Entity(dds_create_reader(participant_.handle(), topic_.handle(), qos_.get(), nullptr), "");
  }
  void write() {
    endpoint_ = Entity(dds_create_writer(participant_.handle(), topic_.handle(), qos_.get(), nullptr), "");
  }

  /// The next message, which lives as long as this object; null if none comes.
  const T* take() {
    dds_sample_info_t info;
    const bool came = eventually([&] {
      sample_[0] = nullptr;
      return dds_take(endpoint_.handle(), sample_, &info, 1, 1) == 1 && info.valid_data;
    });
    return came ? static_cast<const T*>(sample_[0]) : nullptr;
  }
  bool send(const T& message) { return dds_write(endpoint_.handle(), &message) == DDS_RETCODE_OK; }

 private:
  static dds_qos_t* default_qos() {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 100);
    return qos;
  }

  Entity participant_, topic_;
  std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)> qos_;
  void* sample_[1] = {nullptr};
  Entity endpoint_;
};

}  // namespace edged::ros2
