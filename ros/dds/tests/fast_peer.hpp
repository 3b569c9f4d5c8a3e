// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: endpoints of Fast DDS, the implementation that most installations of ROS 2 use, with its own CDR.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/test_UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace edged::fast {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// Passes the bytes that eprosima::fastcdr makes or reads.
class BytesType final : public dds::TopicDataType {
 public:
  explicit BytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 16;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<std::string*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<char*>(payload->data), payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// Writes one message.
class Encoder {
 public:
  explicit Encoder(std::size_t most_bytes) : memory_(most_bytes), buffer_(memory_.data(), memory_.size()) {
    cdr_.serialize_encapsulation();
  }
  template <typename T>
  Encoder& operator<<(const T& value) {
    cdr_ << value;
    return *this;
  }
  void header(std::int64_t ns, const std::string& frame) {
    *this << static_cast<std::int32_t>(ns / 1'000'000'000) << static_cast<std::uint32_t>(ns % 1'000'000'000) << frame;
  }
  void doubles(std::initializer_list<double> values) {
    for (const double value : values) cdr_ << value;
  }
  void zeros(int count) {
    for (int i = 0; i < count; ++i) cdr_ << 0.0;
  }
  std::string bytes() { return {memory_.data(), cdr_.getSerializedDataLength()}; }

 private:
  std::vector<char> memory_;
  eprosima::fastcdr::FastBuffer buffer_;
  eprosima::fastcdr::Cdr cdr_{buffer_, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR};
};

/// Reads one message; throws where it is too short.
class Decoder {
 public:
  explicit Decoder(const std::string& bytes)
      : memory_(bytes.begin(), bytes.end()), buffer_(memory_.data(), memory_.size()) {
    cdr_.read_encapsulation();
  }
  template <typename T>
  T get() {
    T value{};
    cdr_ >> value;
    return value;
  }
  bool at_end() const {  // but for the padding
    return cdr_.getSerializedDataLength() + 4 > memory_.size();
  }

 private:
  std::vector<char> memory_;
  eprosima::fastcdr::FastBuffer buffer_;
  eprosima::fastcdr::Cdr cdr_{buffer_, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::Cdr::DDS_CDR};
};

struct FastQos {
  bool reliable = true, latched = false;
  int depth = 10;
};

/// Keeps all that comes.
class Collector final : public dds::DataReaderListener {
 public:
  void on_data_available(dds::DataReader* reader) override {
    std::string message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const std::lock_guard lock(mutex_);
      messages_.push_back(std::move(message));
      arrivals_us_.push_back(
          std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
              .count());
    }
  }
  std::vector<std::string> messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  std::vector<std::int64_t> arrivals_us() const {  ///< since 1970
    const std::lock_guard lock(mutex_);
    return arrivals_us_;
  }
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return messages_.size();
  }

 private:
  using ReturnCode_t = eprosima::fastrtps::types::ReturnCode_t;
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
  std::vector<std::int64_t> arrivals_us_;
};

/// With unicast discovery on this machine: as ROS_LOCALHOST_ONLY of Humble has it (the loopback interface only) or as
/// ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST (all interfaces).
class Participant {
 public:
  explicit Participant(std::uint32_t domain, bool loopback_only = true) {
    dds::DomainParticipantQos qos;
    auto udp = std::make_shared<eprosima::fastdds::rtps::test_UDPv4TransportDescriptor>();
    udp->messages_filter_ = [lost_percent = lost_percent_](const auto&) {
      thread_local std::minstd_rand random;
      return std::uniform_real_distribution(0.0, 100.0)(random) < *lost_percent;
    };
    if (loopback_only) udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->receiveBufferSize = udp->sendBufferSize = 4 << 20;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    auto& builtin = qos.wire_protocol().builtin;
    rtps::Locator_t own;
    rtps::IPLocator::setIPv4(own, "127.0.0.1");
    builtin.metatrafficUnicastLocatorList.push_back(own);
    for (std::uint32_t i = 0; i < 8; ++i) {
      rtps::Locator_t peer;
      rtps::IPLocator::setIPv4(peer, "127.0.0.1");
      rtps::IPLocator::setPhysicalPort(peer, static_cast<std::uint16_t>(7410 + 250 * domain + 2 * i));
      builtin.initialPeersList.push_back(peer);
    }
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Participant() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Applies to the packets that it sends from now on.
  void lose(double percent) { *lost_percent_ = percent; }

  /// topic: "/imu"; type: "sensor_msgs::msg::dds_::Imu_".
  dds::DataWriter* writer(const std::string& topic, const std::string& type, const FastQos& wanted) {
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    fill(qos, wanted);
    qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
    // What is lost is sent again after the next heartbeat, by default of 3 s.
    qos.reliable_writer_qos().times.heartbeatPeriod = {0, 100'000'000};
    return publisher_->create_datawriter(make_topic(topic, type), qos);
  }
  dds::DataReader* reader(const std::string& topic, const std::string& type, const FastQos& wanted,
                          Collector& collector) {
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    fill(qos, wanted);
    return subscriber_->create_datareader(make_topic(topic, type), qos, &collector);
  }

 private:
  template <typename EndpointQos>
  static void fill(EndpointQos& qos, const FastQos& wanted) {
    qos.reliability().kind = wanted.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = wanted.latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = wanted.depth;
    qos.resource_limits().max_samples = qos.resource_limits().max_samples_per_instance = wanted.depth + 1;
    qos.resource_limits().allocated_samples = 1;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  }
  dds::Topic* make_topic(const std::string& topic, const std::string& type) {
    dds::TypeSupport(new BytesType(type)).register_type(participant_);
    if (auto* known = dynamic_cast<dds::Topic*>(participant_->lookup_topicdescription("rt" + topic))) return known;
    return participant_->create_topic("rt" + topic, type, dds::TOPIC_QOS_DEFAULT);
  }

  const std::shared_ptr<std::atomic<double>> lost_percent_ = std::make_shared<std::atomic<double>>(0.0);
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
};

}  // namespace edged::fast
