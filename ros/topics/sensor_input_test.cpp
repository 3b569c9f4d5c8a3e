// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "topics/sensor_input.hpp"

#include <gmock/gmock.h>

#include "edged/io/parse/evt.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"
#include "edged/io/ros/messages/wire.hpp"

namespace edged::node {
namespace {

using ::testing::HasSubstr;

constexpr Timestamp kStart = timestamp_from_ns(1'700'000'000'000'000'000);
constexpr const char* kDvs = "dvs_msgs/EventArray";

std::optional<Measurement> read(SensorInput& input, const std::string& type, const std::string& bytes) {
  return input.read({type, std::string(ros1_md5_of(type)), as_bytes(bytes)});
}

/// The header's number is the first field.
std::string numbered(std::string message, std::uint32_t number) {
  std::memcpy(message.data(), &number, sizeof number);
  return message;
}

TEST(SensorInput, ReadsTheEventsOfEveryDriver) {
  const EventBatch batch = bag_events(kStart, 20, 1);
  SensorInput input(Wire::Ros1, Role::Events, "dvs");
  for (const char* type : {kDvs, "prophesee_event_msgs/EventArray", "dv_ros_msgs/EventArray"}) {
    const auto measurement = read(input, type, event_array_message(Wire::Ros1, batch, kBagSensor));
    ASSERT_TRUE(measurement) << input.counters().trouble;
    EXPECT_EQ(std::get<EventBatch>(*measurement).camera, "dvs");
    EXPECT_TRUE(std::get<EventBatch>(*measurement).events == batch.events) << type;
  }
  const std::string word(8, '\0');  // of encoding mono: time base, pixel 0, 0
  const auto packet =
      read(input, "event_camera_msgs/EventPacket",
           event_packet_message(Wire::Ros1, kStart, 0, static_cast<std::uint64_t>(to_ns(kStart)), "mono", word));
  ASSERT_TRUE(packet) << input.counters().trouble;
  EXPECT_EQ(std::get<EventBatch>(*packet).events.size(), 1U);
  EXPECT_EQ(input.counters().messages, 4U);
  EXPECT_EQ(input.counters().events, 61U);
}

TEST(SensorInput, ReadsImagesAndImuSamples) {
  SensorInput frames(Wire::Ros1, Role::Frames, "cam"), imu(Wire::Ros1, Role::Imu, "");
  const auto frame =
      read(frames, "sensor_msgs/Image", image_message(Wire::Ros1, {kStart, "", cv::Mat(4, 6, CV_8UC1, cv::Scalar(7))}));
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<Frame>(*frame).camera, "cam");
  EXPECT_EQ(std::get<Frame>(*frame).t, kStart);
  EXPECT_EQ(std::get<Frame>(*frame).image.at<std::uint8_t>(3, 5), 7);
  const auto sample = read(imu, "sensor_msgs/Imu",
                           imu_message(Wire::Ros1, {kStart, Eigen::Vector3d(1, 2, 3), Eigen::Vector3d::Ones()}));
  ASSERT_TRUE(sample);
  EXPECT_EQ(std::get<ImuSample>(*sample).gyro_B, Eigen::Vector3d(1, 2, 3));
}

TEST(SensorInput, ReadsHeightsAndVelocitiesAsBagsAreRead) {
  SensorInput height(Wire::Ros1, Role::Height, ""), velocity(Wire::Ros1, Role::Velocity, "");
  const auto pressure =
      height.read({"sensor_msgs/FluidPressure", "", as_bytes(pressure_message(Wire::Ros1, kStart, 101325.0))});
  ASSERT_TRUE(pressure) << height.counters().trouble;
  EXPECT_NEAR(std::get<HeightSample>(std::get<ExternalSample>(*pressure)).height_m, 0.0, 1e-6);
  const auto twist =
      velocity.read({"geometry_msgs/TwistStamped", "", as_bytes(twist_message(Wire::Ros1, kStart, {1, 2, 3}))});
  ASSERT_TRUE(twist) << velocity.counters().trouble;
  EXPECT_EQ(std::get<VelocitySample>(std::get<ExternalSample>(*twist)).v_S, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(velocity.counters().optional);
  EXPECT_FALSE(velocity.read({"sensor_msgs/Range", "", as_bytes(std::string(40, '\0'))}));
}

TEST(SensorInput, WhatCannotBeReadIsCountedWithItsReason) {
  const std::string message = event_array_message(Wire::Ros1, bag_events(kStart, 20, 1), kBagSensor);
  SensorInput input(Wire::Ros1, Role::Events, "dvs");
  EXPECT_FALSE(read(input, kDvs, message.substr(0, 100)));
  EXPECT_FALSE(read(input, "sensor_msgs/Imu", message));
  EXPECT_THAT(input.counters().trouble, HasSubstr("sensor_msgs/Imu: cannot be events"));
  EXPECT_FALSE(input.read({kDvs, "another", as_bytes(message)}));
  EXPECT_THAT(input.counters().trouble, HasSubstr("dvs_msgs/EventArray: of another version: md5 another"));
  EXPECT_FALSE(read(input, kDvs, ""));
  EXPECT_EQ(input.counters().messages, 4U);
  EXPECT_EQ(input.counters().unreadable, 4U);
}

TEST(SensorInput, GapsInTheNumbersOfTheHeadersAreMissedMessages) {
  const std::string message = imu_message(Wire::Ros1, {kStart, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  SensorInput input(Wire::Ros1, Role::Imu, "");
  for (const std::uint32_t number : {10U, 11U, 15U, 16U}) read(input, "sensor_msgs/Imu", numbered(message, number));
  EXPECT_EQ(input.counters().missed, 3U);
  for (const std::uint32_t begun_anew : {0U, 1U, 1U}) read(input, "sensor_msgs/Imu", numbered(message, begun_anew));
  EXPECT_EQ(input.counters().missed, 3U);
}

/// A packet of ROS 2 of encoding mono, with an event at each of these times after kStart.
std::optional<Measurement> read_packet(SensorInput& input, std::uint64_t sequence, std::initializer_list<int> times_ms,
                                       int stamp_ms = 0) {
  std::string words;
  for (const int ms : times_ms) append_number(words, static_cast<std::uint64_t>(ms) * 1'000'000);
  const std::string message = event_packet_message(Wire::Cdr, kStart + std::chrono::milliseconds(stamp_ms), sequence,
                                                   static_cast<std::uint64_t>(to_ns(kStart)), "mono", words);
  return input.read({"event_camera_msgs/EventPacket", "", as_bytes(message)});
}

TEST(SensorInput, OfRos2GapsInTheNumbersOfPacketsAreMissedMessages) {
  SensorInput input(Wire::Cdr, Role::Events, "dvs");
  for (const std::uint64_t sequence : {7, 8, 12, 3, 4}) ASSERT_TRUE(read_packet(input, sequence, {1}));
  EXPECT_EQ(input.counters().missed, 3U);
  ASSERT_TRUE(read_packet(input, std::uint64_t{1} << 40U, {1}));  // as metavision_driver #77 has it
  EXPECT_EQ(input.counters().missed, 4U);
}

/// Samples of an IMU of ROS 2 at these intervals. Returns how many seem to be missed.
std::size_t missed_of(const std::vector<int>& intervals_us) {
  SensorInput input(Wire::Cdr, Role::Imu, "");
  Timestamp t = kStart;
  for (const int interval : intervals_us) {
    t += std::chrono::microseconds(interval);
    const std::string message = imu_message(Wire::Cdr, {t, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    const std::optional<Measurement> sample = input.read({"sensor_msgs/Imu", "", as_bytes(message)});
    input.note_time(std::get<ImuSample>(sample.value()).t);
  }
  return input.counters().missed;
}

TEST(SensorInput, OfRos2GapsInTheStampsOfTheImuAreMissedMessages) {
  std::vector<int> intervals(150, 1000);
  for (std::size_t i = 0; i < intervals.size(); i += 2) intervals[i] = 1100;
  EXPECT_EQ(missed_of(intervals), 0U);
  intervals[120] = 2000;       // one is lost
  intervals[130] = 5000;       // four
  intervals[140] = 3'000'000;  // the driver was away
  intervals[145] = -8000;
  EXPECT_EQ(missed_of(intervals), 5U);
  std::vector<int> bursts(300, 10);
  for (std::size_t i = 0; i < bursts.size(); i += 4) bursts[i] = 4000;
  EXPECT_EQ(missed_of(bursts), 0U);
}

TEST(SensorInput, TimeThatJumpsWithinAPacketIsCountedAndTheEventsAreKept) {
  SensorInput input(Wire::Cdr, Role::Events, "dvs");
  const auto measurement = read_packet(input, 0, {0, 1, 3000, 2990, 2991});
  ASSERT_TRUE(measurement);
  EXPECT_EQ(std::get<EventBatch>(*measurement).events.size(), 5U);
  EXPECT_EQ(input.counters().time_back, 1U);
  EXPECT_EQ(input.counters().time_ahead, 1U);
}

TEST(SensorInput, StampsOfArrivalAreFoundByTheirDeviationFromTheClockOfTheSensor) {
  SensorInput input(Wire::Cdr, Role::Events, "dvs");
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(read_packet(input, static_cast<std::uint64_t>(i), {10 * i}, 10 * i));
  EXPECT_LT(input.counters().stamp_jitter, std::chrono::microseconds(1));
  ASSERT_TRUE(read_packet(input, 5, {50}, 57));
  EXPECT_GT(input.counters().stamp_jitter, std::chrono::microseconds(6900));
}

TEST(SensorInput, EventsWithoutTheirTimeAfterAMissingPacketAreCounted) {
  EvtEncoder encoder(EvtFormat::Evt3);
  const std::vector<Event> first = {{kStart, 5, 6, true}},
                           second = {{kStart + std::chrono::microseconds(3), 5, 6, true}};
  const std::string begin = encoder.encode(first), next = encoder.encode(second);
  SensorInput input(Wire::Cdr, Role::Events, "dvs");
  for (const auto& [sequence, words] : {std::pair(1, begin), std::pair(2, next), std::pair(9, next)})
    input.read({"event_camera_msgs/EventPacket", "",
                as_bytes(event_packet_message(Wire::Cdr, kStart, sequence, 0, "evt3", words))});
  EXPECT_EQ(input.counters().events + input.counters().left_out, 3U);
  EXPECT_EQ(input.counters().left_out, 1U);
}

}  // namespace
}  // namespace edged::node
