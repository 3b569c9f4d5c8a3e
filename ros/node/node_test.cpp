// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/node.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

#include "edged/checks/agreement/test_head.hpp"
#include "edged/core/check.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"
#include "edged/io/ros/messages/wire.hpp"
#include "edged/io/test_support.hpp"
#include "node/node_test_support.hpp"

namespace edged::node {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

NodeConfig davis_config() {
  NodeConfig config;
  config.rig = "davis240c_ecd";
  return config;
}

TEST(Node, TwoSensorsOnOneTopicAreRefused) {
  KeptTransport transport(Wire::Cdr);
  transport.remapped = {{"imu", "/all"}, {"velocity", "/all"}};
  EXPECT_THAT([&] { Node(davis_config(), load_node_rig(davis_config()), transport); },
              ThrowsMessage<InputError>("/all is used for both imu and velocity: remap one of them"));
}

TEST(Node, AMapThatCannotBeUsedIsRefused) {
  KeptTransport transport(Wire::Cdr);
  NodeConfig config = davis_config();
  config.options.map.localize_only = true;
  EXPECT_THAT([&] { Node(config, load_node_rig(config), transport); },
              ThrowsMessage<InputError>("map.localize_only needs the map to localize in: set map_file, too"));
  config.map_file = "/nowhere/lab.map";
  EXPECT_THAT([&] { Node(config, load_node_rig(config), transport); },
              ThrowsMessage<InputError>("map_file /nowhere/lab.map: cannot be read"));
}

TEST(Node, StopsTheTransportWhenItFails) {
  KeptTransport transport(Wire::Cdr);
  Node node(davis_config(), load_node_rig(davis_config()), transport);
  const auto fails = [&]() -> bool {
    EXPECT_TRUE(transport.runs);
    throw std::runtime_error("broken");
  };
  EXPECT_THROW(node.run(fails), std::runtime_error);
  EXPECT_FALSE(transport.runs);
}

/// The result of one request to a node that has seen nothing.
std::string result_of(const NodeConfig& config, const std::string& topic, const std::string& file) {
  KeptTransport transport(Wire::Ros1);
  Node node(config, load_node_rig(config), transport);
  WireWriter text(Wire::Ros1);
  text.text(file);
  const std::string bytes = text.message();
  bool asked = false;
  const Diagnosis end = node.run([&] {
    if (!std::exchange(asked, true)) {
      transport.receivers.at(topic)({"std_msgs/String", "", as_bytes(bytes)});
      return false;
    }
    return true;
  });
  const auto found = std::ranges::find(end.values, "last request", &std::pair<std::string, std::string>::first);
  return found == end.values.end() ? "" : found->second;
}

TEST(Node, RequestsHaveTheirResultInTheDiagnostics) {
  EXPECT_EQ(result_of(davis_config(), "~/reset", ""), "reset: the estimate starts again, in a new map");
  EXPECT_EQ(result_of(davis_config(), "~/load_map", "/nowhere/lab.map"),
            "load_map /nowhere/lab.map: not done: cannot be read");
  EXPECT_EQ(result_of(davis_config(), "~/save_map", "/nowhere/lab.map"),
            "save_map /nowhere/lab.map: not done: no keyframe has left the window yet, or map.enabled is false");
}

TEST(Requests, AMapFileIsReplacedAtOnceAndNoOtherFileIs) {
  const TempFolder folder;
  const std::string file = (folder.path() / "lab.map").string();
  write_map_file(file, "maps 1\nfirst");
  write_map_file(file, "maps 1\nsecond");
  EXPECT_EQ(read_map_file(file), "maps 1\nsecond");
  EXPECT_FALSE(std::filesystem::exists(file + ".part"));
  EXPECT_THAT([&] { write_map_file(folder.write("notes.txt", "dear diary").string(), "maps 1\nthird"); },
              ThrowsMessage<InputError>(HasSubstr("is there and no map")));
  EXPECT_THAT([&] { write_map_file((folder.path() / "no" / "lab.map").string(), "maps 1\n"); },
              ThrowsMessage<InputError>(HasSubstr("cannot be written")));
  EXPECT_THAT([&] { read_map_file(folder.path().string()); }, ThrowsMessage<InputError>("cannot be read"));
}

TEST(Requests, DamagedOnesAreLeftOutAndTheOthersKeepTheirOrder) {
  KeptTransport transport(Wire::Cdr);
  Requests requests(transport);
  transport.receivers.at("~/save_map")({"std_msgs/String", "", {}});
  transport.receivers.at("~/reset")({"std_msgs/Empty", "", {}});
  for (int i = 0; i < 100; ++i) transport.receivers.at("~/reset")({"std_msgs/Empty", "", {}});
  int resets = 0;
  while (const auto request = requests.next()) {
    EXPECT_EQ(request->text(), "reset");
    ++resets;
  }
  EXPECT_EQ(resets, 20) << "more than so many wait for nobody";
}

/// The messages of a driver of ROS 1.
class Driver {
 public:
  explicit Driver(KeptTransport& transport) : transport_(transport) {}
  void send_events(Timestamp t, int count) {
    send("events", "dvs_msgs/EventArray", event_array_message(Wire::Ros1, bag_events(t, count, 1), kBagSensor));
  }
  void send_frame(Timestamp t) { send(Frame{t, "", cv::Mat(180, 240, CV_8UC1, cv::Scalar(7))}); }
  void send_imu(Timestamp t) { send(ImuSample{t, Eigen::Vector3d::Zero(), {0.0, 0.0, 9.81}}); }
  void send(const Frame& frame) { send("image", "sensor_msgs/Image", image_message(Wire::Ros1, frame)); }
  void send(const ImuSample& sample) { send("imu", "sensor_msgs/Imu", imu_message(Wire::Ros1, sample)); }

 private:
  void send(const std::string& topic, const std::string& type, const std::string& bytes) {
    transport_.receivers.at(topic)({type, std::string(ros1_md5_of(type)), as_bytes(bytes)});
  }
  KeptTransport& transport_;
};

std::size_t count_of(const Diagnosis& diagnosis, const std::string& key) {
  const auto found = std::ranges::find(diagnosis.values, key, &std::pair<std::string, std::string>::first);
  return found == diagnosis.values.end() ? 0 : std::stoul(found->second);
}

NodeConfig impatient_config() {
  NodeConfig config = davis_config();
  config.max_age_s = 0.05;
  return config;
}

TEST(Node, DropsEventsThenFramesNeverTheImuWhileTheOdometryIsBusy) {
  constexpr int kEvents = 1000;
  KeptTransport transport(Wire::Ros1);
  Driver driver(transport);
  Node node(impatient_config(), load_node_rig(impatient_config()), transport);
  const Diagnosis end = node.run([&] {  // in the thread of the odometry
    for (const double t : {100.0, 100.12}) {
      if (t > 100.0) std::this_thread::sleep_for(std::chrono::milliseconds(120));
      driver.send_events(timestamp_from_seconds(t), kEvents);
      driver.send_imu(timestamp_from_seconds(t));
      driver.send_frame(timestamp_from_seconds(t));
    }
    return true;
  });
  EXPECT_EQ(count_of(end, "events events"), 2U * kEvents);
  EXPECT_EQ(count_of(end, "imu messages"), 2U);
  // The first ones have waited too long; of the second events a small share is kept.
  EXPECT_GT(count_of(end, "events left out, too slow"), 18U * kEvents / 10);
  EXPECT_LT(count_of(end, "events left out, too slow"), 2U * kEvents);
  EXPECT_EQ(count_of(end, "frames left out, too slow"), 1U);
}

TEST(Node, DropsNothingWhileTheOdometryWaitsForASensor) {
  KeptTransport transport(Wire::Ros1);
  Driver driver(transport);
  Node node(impatient_config(), load_node_rig(impatient_config()), transport);
  int sent = 0;
  const Diagnosis end = node.run([&] {
    const Timestamp t = timestamp_from_seconds(100.0 + 0.01 * sent);
    if (sent < 50) driver.send_events(t, 100);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return ++sent > 60;
  });
  EXPECT_EQ(count_of(end, "events events"), 5000U);
  EXPECT_EQ(count_of(end, "events left out, too slow"), 0U);
}

TEST(Node, AnImuThatCountsFromItsOwnStartGetsItsOffset) {
  NodeConfig config;
  config.mode = Mode::Frames;
  config.imu_time_offset = "auto";
  config.max_age_s = 3600;
  KeptTransport transport(Wire::Ros1);
  Driver driver(transport);
  Calibration calibration;
  calibration.rig = {"head", {TurningHead::kCamera}};
  Node node(config, calibration, transport);
  TurningHead head;
  double until_s = 0.0;
  const auto step = [&] {
    head.move_until(until_s += 0.5, 1000.0, [&](Measurement measurement) {
      std::visit(
          [&](const auto& value) {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, Frame> || std::is_same_v<T, ImuSample>) driver.send(value);
          },
          measurement);
    });
    return until_s >= 12.0;
  };
  const Diagnosis end = node.run(step);
  EXPECT_EQ(count_of(end, "imu messages"), 2400U);
  EXPECT_GT(count_of(end, "packets"), 40U);
  EXPECT_EQ(count_of(end, "packets after the IMU"), 0U);
  EXPECT_THAT(end.message, Not(HasSubstr("the offset of the IMU's clock is not known")));
}

}  // namespace
}  // namespace edged::node
