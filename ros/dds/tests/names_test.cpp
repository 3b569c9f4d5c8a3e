// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/names.hpp"

#include <gmock/gmock.h>

#include "edged/core/check.hpp"

namespace edged::ros2 {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Ros2Names, TypesAndTopicsAreMangledAsRmwDoes) {
  EXPECT_EQ(dds_type("sensor_msgs/Imu"), "sensor_msgs::msg::dds_::Imu_");
  EXPECT_EQ(ros_type("sensor_msgs::msg::dds_::Imu_"), "sensor_msgs/Imu");
  EXPECT_EQ(ros_type("HelloWorld"), "");
  EXPECT_EQ(dds_topic("/imu/data"), "rt/imu/data");
  EXPECT_EQ(dds_topic("ros_discovery_info"), "ros_discovery_info");
  EXPECT_EQ(type_hash_data("sensor_msgs/Imu"),
            "typehash=RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b;");
}

TEST(Ros2Names, AreResolvedInTheNamespaceAndRemapped) {
  const Names names("drone", "edged", {"events:=/event_camera/events", "~/odometry:=odom", "/tf:=/other_tf"});
  EXPECT_EQ(names.full_name("imu"), "/drone/imu");
  EXPECT_EQ(names.full_name("events"), "/event_camera/events");
  EXPECT_EQ(names.full_name("~/odometry"), "/drone/odom");
  EXPECT_EQ(names.full_name("~/pose"), "/drone/edged/pose");
  EXPECT_EQ(names.full_name("/tf"), "/other_tf");
  EXPECT_EQ(Names("/", "edged", {}).full_name("imu"), "/imu");
  EXPECT_EQ(Names("/", "edged", {"__ns:=/a", "__node:=b"}).full_name("~/pose"), "/a/b/pose");
}

TEST(Ros2Names, WhatIsNoNameIsRefused) {
  const auto message = [](const std::string& text) { return ThrowsMessage<InputError>(HasSubstr(text)); };
  EXPECT_THAT([] { Names("/", "edged", {"events"}); }, message("write it as from:=to"));
  EXPECT_THAT([] { Names("/", "edged", {"events:=/a//b"}); }, message("'/a//b' is not the name of a topic"));
  EXPECT_THAT([] { Names("/", "1st", {}); }, message("'1st' is not the name of a node"));
  EXPECT_THAT([] { Names("/a b", "edged", {}); }, message("'/a b' is not a namespace"));
}

}  // namespace
}  // namespace edged::ros2
