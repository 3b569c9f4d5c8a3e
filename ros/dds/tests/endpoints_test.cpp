// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Names, QoS and discovery data as others see them, and readers of topics whose type is found by discovery.
#include <messages.h>

#include <gmock/gmock.h>

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>

#include "dds/ros2_transport.hpp"
#include "dds_test_support.hpp"
#include "edged/core/check.hpp"
#include "topics/sensor_input.hpp"

namespace edged::ros2 {
namespace {

using ::testing::HasSubstr;

struct Seen {
  std::string type, user_data;
  dds_reliability_kind_t reliability;
  dds_durability_kind_t durability;
  std::int32_t depth;
};

std::string user_data_of(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size)) return "";
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

/// Writers of the domain by their topics, from a built-in topic.
std::map<std::string, Seen> seen_writers(dds_entity_t participant) {
  const Entity reader(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr), "");
  std::map<std::string, Seen> seen;
  void* sample[1] = {nullptr};
  dds_sample_info_t info;
  while (dds_take(reader.handle(), sample, &info, 1, 1) == 1) {
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(sample[0]);
    if (info.valid_data) {
      Seen one{endpoint.type_name, user_data_of(endpoint.qos), {}, {}, 0};
      dds_duration_t block = 0;
      dds_history_kind_t history;
      dds_qget_reliability(endpoint.qos, &one.reliability, &block);
      dds_qget_durability(endpoint.qos, &one.durability);
      dds_qget_history(endpoint.qos, &history, &one.depth);
      seen.emplace(endpoint.topic_name, one);
    }
    dds_return_loan(reader.handle(), sample, 1);
  }
  return seen;
}

TransportSetup setup_of(const std::string& distribution = "") {
  return {test_discovery(), Names("/", "edged", {}), false, false, distribution};
}

TEST(Ros2Endpoints, HaveTheNamesQosAndHashesOfRos2) {
  Ros2Transport transport(setup_of());
  const auto tf = transport.advertise({"/tf", "tf2_msgs/TFMessage", 100});
  const auto fixed = transport.advertise({"/tf_static", "tf2_msgs/TFMessage", 1, true});
  const auto odometry = transport.advertise({"~/odometry", "nav_msgs/Odometry", 10});
  const auto px4 =
      transport.advertise({"/fmu/in/vehicle_visual_odometry", "px4_msgs/VehicleOdometry", 1, false, false});
  const Entity other(dds_create_participant(test_discovery().domain, nullptr, nullptr), "");
  const auto seen = seen_writers(other.handle());
  ASSERT_TRUE(seen.contains("rt/edged/odometry"));
  EXPECT_EQ(seen.at("rt/edged/odometry").type, "nav_msgs::msg::dds_::Odometry_");
  EXPECT_EQ(seen.at("rt/edged/odometry").user_data, type_hash_data("nav_msgs/Odometry"));
  EXPECT_EQ(seen.at("rt/tf").reliability, DDS_RELIABILITY_RELIABLE);
  EXPECT_EQ(seen.at("rt/tf").durability, DDS_DURABILITY_VOLATILE);
  EXPECT_EQ(seen.at("rt/tf").depth, 100);
  EXPECT_EQ(seen.at("rt/tf_static").durability, DDS_DURABILITY_TRANSIENT_LOCAL);
  EXPECT_EQ(seen.at("rt/tf_static").depth, 1);
  const Seen& to_px4 = seen.at("rt/fmu/in/vehicle_visual_odometry");
  EXPECT_EQ(to_px4.reliability, DDS_RELIABILITY_BEST_EFFORT);
  EXPECT_EQ(to_px4.type, "px4_msgs::msg::dds_::VehicleOdometry_");
}

TEST(Ros2Endpoints, TheParticipantNamesItsEnclave) {
  const Participant participant(test_discovery());
  dds_qos_t* qos = dds_create_qos();
  ASSERT_EQ(dds_get_qos(participant.handle(), qos), DDS_RETCODE_OK);
  EXPECT_EQ(user_data_of(qos), "enclave=/;");
  dds_delete_qos(qos);
}

TEST(Ros2Endpoints, NodesAreToldOfEachOtherOnlyForANamedDistribution) {
  {
    const Ros2Transport transport(setup_of());
    EXPECT_FALSE(seen_writers(Participant(test_discovery()).handle()).contains("ros_discovery_info"));
  }
  Ros2Transport transport(setup_of("jazzy"));
  const auto odometry = transport.advertise({"~/odometry", "nav_msgs/Odometry", 10});
  transport.start();
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  TypedPeer<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_> peer(
      "ros_discovery_info", rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc, qos);
  peer.read();
  const auto* info = peer.take();
  ASSERT_TRUE(info);
  ASSERT_EQ(info->node_entities_info_seq._length, 1U);
  const auto& node = info->node_entities_info_seq._buffer[0];
  EXPECT_STREQ(node.node_namespace, "/");
  EXPECT_STREQ(node.node_name, "edged");
  EXPECT_EQ(node.writer_gid_seq._length, 1U);
  EXPECT_EQ(node.reader_gid_seq._length, 0U);
  EXPECT_EQ(gid_bytes_of("humble"), 24U);
  EXPECT_THROW(gid_bytes_of("foxy"), InputError);
}

/// What a subscription of the node receives.
struct Received {
  explicit Received(Role role) : input(Wire::Cdr, role, "cam") {}
  node::Transport::Receive callback() {
    return [this](const node::WireMessage& message) {
      auto measurement = input.read(message);
      const std::lock_guard lock(mutex);
      if (measurement) measurements.push_back(std::move(*measurement));
    };
  }
  bool has(std::size_t count) {
    return eventually([&] {
      const std::lock_guard lock(mutex);
      return measurements.size() >= count;
    });
  }
  node::SensorInput input;
  std::mutex mutex;
  std::vector<Measurement> measurements;
};

const std_msgs_msg_dds__Header_ kHeader{{5, 250'000'000}, const_cast<char*>("sensor")};
constexpr Timestamp kTime = timestamp_from_ns(5'250'000'000);

/// Sends a typed message until it has been received: a reader is made once the writer is known.
template <typename T>
void send_until_received(const std::string& topic, const dds_topic_descriptor_t& type, const T& message,
                         Received& received) {
  TypedPeer<T> peer(topic, type);
  peer.write();
  EXPECT_TRUE(eventually([&] {
    peer.send(message);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::lock_guard lock(received.mutex);
    return !received.measurements.empty();
  })) << received.input.counters().trouble;
}

TEST(Ros2Endpoints, ReadImuSamplesAndImages) {
  Ros2Transport transport(setup_of());
  Received imu(Role::Imu), frames(Role::Frames);
  transport.subscribe("/imu", Role::Imu, imu.callback());
  transport.subscribe("/image", Role::Frames, frames.callback());
  transport.start();
  sensor_msgs_msg_dds__Imu_ sample{};
  sample.header = kHeader;
  sample.angular_velocity = {1, 2, 3};
  sample.linear_acceleration = {4, 5, 6};
  send_until_received("/imu", sensor_msgs_msg_dds__Imu__desc, sample, imu);
  std::uint8_t pixels[6] = {1, 2, 3, 4, 5, 6};
  sensor_msgs_msg_dds__Image_ image{};
  image.header = kHeader;
  image.height = 2, image.width = 3, image.step = 3;
  image.encoding = const_cast<char*>("mono8");
  image.data._buffer = pixels, image.data._length = image.data._maximum = 6;
  send_until_received("/image", sensor_msgs_msg_dds__Image__desc, image, frames);
  transport.stop();
  EXPECT_EQ(std::get<ImuSample>(imu.measurements.at(0)).accel_B, Eigen::Vector3d(4, 5, 6));
  const auto& frame = std::get<Frame>(frames.measurements.at(0));
  EXPECT_EQ(frame.t, kTime);
  EXPECT_EQ(frame.image.at<std::uint8_t>(1, 2), 6);
}

TEST(Ros2Endpoints, ReadEventPacketsAndExternalSensors) {
  Ros2Transport transport(setup_of());
  Received events(Role::Events), height(Role::Height), velocity(Role::Velocity);
  transport.subscribe("/events", Role::Events, events.callback());
  transport.subscribe("/height", Role::Height, height.callback());
  transport.subscribe("/velocity", Role::Velocity, velocity.callback());
  transport.start();
  std::uint8_t word[8] = {0x10, 0x27, 0, 0, 7, 0, 9, 0x80};  // 10 us, column 7, row 9, positive
  event_camera_msgs_msg_dds__EventPacket_ packet{};
  packet.header = kHeader;
  packet.height = 180, packet.width = 240, packet.time_base = 1000;
  packet.encoding = const_cast<char*>("mono");
  packet.events._buffer = word, packet.events._length = packet.events._maximum = 8;
  send_until_received("/events", event_camera_msgs_msg_dds__EventPacket__desc, packet, events);
  sensor_msgs_msg_dds__Range_ range{};
  range.header = kHeader;
  range.min_range = 0.1F, range.max_range = 10.0F, range.range = 2.5F;
  send_until_received("/height", sensor_msgs_msg_dds__Range__desc, range, height);
  geometry_msgs_msg_dds__TwistWithCovarianceStamped_ twist{};
  twist.header = kHeader;
  twist.twist.twist.linear = {1, 2, 3};
  send_until_received("/velocity", geometry_msgs_msg_dds__TwistWithCovarianceStamped__desc, twist, velocity);
  transport.stop();
  const Event event = std::get<EventBatch>(events.measurements.at(0)).events.at(0);
  EXPECT_EQ(event.t, kTime + std::chrono::microseconds(10));
  EXPECT_EQ(event.x, 7);
  EXPECT_EQ(event.y, 9);
  EXPECT_TRUE(event.positive);
  EXPECT_EQ(std::get<HeightSample>(std::get<ExternalSample>(height.measurements.at(0))).height_m, 2.5);
  EXPECT_EQ(std::get<VelocitySample>(std::get<ExternalSample>(velocity.measurements.at(0))).v_S,
            Eigen::Vector3d(1, 2, 3));
}

TEST(Ros2Endpoints, AWrongTypeIsNamedWithTheRemedy) {
  Ros2Transport transport(setup_of());
  transport.subscribe("/imu", Role::Imu, [](const node::WireMessage&) {});
  transport.start();
  auto peer = std::make_unique<TypedPeer<sensor_msgs_msg_dds__Range_>>("/imu", sensor_msgs_msg_dds__Range__desc);
  peer->write();
  EXPECT_TRUE(eventually([&] { return !transport.troubles().at("/imu").trouble.empty(); }));
  EXPECT_THAT(transport.troubles().at("/imu").trouble, HasSubstr("sends sensor_msgs/Range"));
  peer.reset();
  EXPECT_TRUE(eventually([&] { return transport.troubles().at("/imu").trouble.empty(); }));
}

TEST(Ros2Endpoints, APublisherOfBestEffortIsNamedToAReliableReader) {
  TransportSetup setup = setup_of();
  setup.reliable = true;
  Ros2Transport transport(setup);
  transport.subscribe("/imu", Role::Imu, [](const node::WireMessage&) {});
  transport.start();
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  auto peer = std::make_unique<TypedPeer<sensor_msgs_msg_dds__Imu_>>("/imu", sensor_msgs_msg_dds__Imu__desc, qos);
  peer->write();
  EXPECT_TRUE(eventually([&] { return !transport.troubles().at("/imu").trouble.empty(); }));
  EXPECT_THAT(transport.troubles().at("/imu").trouble, HasSubstr("best effort"));
  peer.reset();
  EXPECT_TRUE(eventually([&] { return transport.troubles().at("/imu").trouble.empty(); }));
}

TEST(Ros2Endpoints, AReaderThatIsFullCountsWhatItRefuses) {
  const Participant participant(test_discovery());
  const Writer writer(participant, "/full", "sensor_msgs/Imu", {.reliable = false, .depth = 100});
  Reader reader(participant, "/full", "sensor_msgs/Imu", {.reliable = false, .depth = 4});
  ASSERT_TRUE(eventually([&] { return writer.readers() == 1; }));
  for (int i = 0; i < 10; ++i) writer.write(std::string("\0\1\0\0abcd", 8));
  EXPECT_EQ(reader.take().size(), 4U);
  EXPECT_EQ(reader.refused(), 6U);
  EXPECT_EQ(reader.lost(), 0U);
}

TEST(Ros2Endpoints, WhatHasArrivedIsReceivedBeforeTheStop) {
  const Participant participant(test_discovery());
  const Writer writer(participant, "/waiting", "sensor_msgs/Imu", {.depth = 100});
  std::atomic<int> received = 0;
  Subscription::Setup setup{"/waiting", {.depth = 100}};
  setup.accepts = [](const std::string&) { return true; };
  setup.receive = [&](const std::string&, ByteSpan) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ++received;
  };
  Subscription subscription(participant, std::move(setup));
  ASSERT_TRUE(eventually([&] { return writer.readers() == 1; }));
  for (int i = 0; i < 90; ++i) EXPECT_TRUE(writer.write(std::string("\0\1\0\0abcd", 8)));
  subscription.stop();
  EXPECT_EQ(received, 90);
}

/// One domain by other entities: what passes between them goes over the network, which loses so many of 1000
/// packets that these entities send.
Discovery test_discovery_of_another_process(int lost_per_mille = 0) {
  Discovery discovery = test_discovery();
  discovery.cyclone_uri = fmt::format(
      "<CycloneDDS><Domain id=\"any\"><Discovery><ExternalDomainId>{}</ExternalDomainId></Discovery>"
      "<Internal><Test><XmitLossiness>{}</XmitLossiness></Test></Internal></Domain></CycloneDDS>",
      discovery.domain, lost_per_mille);
  discovery.domain += 100;
  return discovery;
}

/// Returns how many messages were dropped of 200 that a reliable reader of another process does not take.
int dropped_for_a_slow_reader(Duration longest_block) {
  const Participant participant(test_discovery()), other(test_discovery_of_another_process());
  const Writer writer(participant, "/slow", "sensor_msgs/Imu", {.depth = 10, .longest_block = longest_block});
  Reader reader(other, "/slow", "sensor_msgs/Imu", {.depth = 4});
  EXPECT_TRUE(eventually([&] { return writer.readers() == 1 && reader.writers() == 1; }));
  std::string message(100'000, 'x');
  message.replace(0, 4, std::string("\0\1\0\0", 4));
  int dropped = 0;
  for (int i = 0; i < 200 && dropped < 3; ++i) dropped += writer.write(message) ? 0 : 1;
  EXPECT_TRUE(eventually([&] { return !reader.take().empty(); }));
  return dropped;
}

TEST(Ros2Endpoints, AWriterThatWaitsForASlowReaderKnowsWhatItDrops) {
  EXPECT_EQ(dropped_for_a_slow_reader(std::chrono::milliseconds(50)), 3);
  EXPECT_EQ(dropped_for_a_slow_reader(Duration(0)), 0);
}

TEST(Ros2Endpoints, WhatTheNetworkLosesIsCountedForAReaderOfBestEffort) {
  constexpr int kSent = 2000;
  const Participant lossy(test_discovery_of_another_process(100)), participant(test_discovery());
  const Writer writer(lossy, "/lossy", "sensor_msgs/Image", {.reliable = false, .depth = 100});
  Reader reader(participant, "/lossy", "sensor_msgs/Image", {.reliable = false, .depth = kSent});
  ASSERT_TRUE(eventually([&] { return writer.readers() == 1 && reader.writers() == 1; }));
  std::vector<int> received;
  for (int i = 0; i < kSent; ++i) {
    std::string message("\0\1\0\0abcd", 8);
    std::memcpy(message.data() + 4, &i, sizeof i);
    message.resize(i % 2 == 0 ? 8 : 4000, 'x');  // whole and in fragments
    writer.write(message);
  }
  const auto take = [&] {
    for (const auto& message : reader.take())
      std::memcpy(&received.emplace_back(), message->cdr().data() + 4, sizeof(int));
    return received.size();
  };
  ASSERT_TRUE(eventually([&] { return take() > 0 && received.back() > kSent - 20; }));
  EXPECT_EQ(reader.lost(), static_cast<std::size_t>(received.back() - received.front() + 1) - received.size());
  EXPECT_GT(reader.lost(), std::size_t{50});
}

TEST(Ros2Endpoints, SimulatedTimeIsThatOfTheClock) {
  TransportSetup setup = setup_of();
  setup.use_sim_time = true;
  setup.names.emplace("/", "edged", std::vector<std::string>{"/clock:=/sim/clock"});
  Ros2Transport transport(setup);
  EXPECT_EQ(transport.now(), Timestamp());
  EXPECT_THAT(transport.troubles().at("/sim/clock").trouble, HasSubstr("start the simulator"));
  TypedPeer<rosgraph_msgs_msg_dds__Clock_> peer("/sim/clock", rosgraph_msgs_msg_dds__Clock__desc);
  peer.write();
  EXPECT_TRUE(eventually([&] {
    peer.send({{5, 250'000'000}});
    return transport.now() == kTime;
  }));
  EXPECT_TRUE(transport.troubles().empty());
  transport.stop();
  peer.send({{6, 0}});
  EXPECT_EQ(transport.now(), kTime);
}

}  // namespace
}  // namespace edged::ros2
