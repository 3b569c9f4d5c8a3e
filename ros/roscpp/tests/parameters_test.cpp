// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "roscpp/parameters.hpp"

#include <gmock/gmock.h>

#include "edged/core/check.hpp"

namespace edged::ros1 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using XmlRpc::XmlRpcValue;

XmlRpcValue with_rig() {
  XmlRpcValue parameters;
  parameters["rig"] = "davis240c_ecd";
  return parameters;
}

node::NodeConfig config_of(const XmlRpcValue& parameters) {
  node::NodeConfig config;
  set_parameters(config, parameters);
  return config;
}

TEST(Parameters, OfTheNodeAndOptionsOfTheOdometryAreSet) {
  XmlRpcValue parameters = with_rig();
  parameters["mode"] = "events";
  parameters["odom_frame"] = "odometry";
  parameters["publish_tf"] = false;
  parameters["delays"]["imu_s"] = 1;
  parameters["options"]["packets"]["max_interval_s"] = 0.03;
  parameters["options"]["estimator.keyframes"] = 6;
  const node::NodeConfig config = config_of(parameters);
  EXPECT_EQ(config.rig, "davis240c_ecd");
  EXPECT_EQ(config.mode, Mode::Events);
  EXPECT_EQ(config.frames.odom, "odometry");
  EXPECT_FALSE(config.publish_tf);
  EXPECT_EQ(config.delays.imu_s, 1.0);
  EXPECT_EQ(config.options.packets.max_interval_s, 0.03);
  EXPECT_EQ(config.options.estimator.keyframes, 6);
}

TEST(Parameters, ATypingErrorIsNamedWithTheNearestKnownOne) {
  XmlRpcValue parameters = with_rig();
  parameters["options"]["packets"]["max_intervall_s"] = 0.03;
  EXPECT_THAT([&] { config_of(parameters); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("~options/packets/max_intervall_s"), HasSubstr("options.packets.max_interval_s"))));
}

TEST(Parameters, WhatIsOutOfItsRangeOrAListIsNamed) {
  XmlRpcValue parameters = with_rig();
  parameters["mode"] = "video";
  EXPECT_THAT([&] { config_of(parameters); }, ThrowsMessage<InputError>(HasSubstr("parameter ~mode: ")));
  parameters = with_rig();
  parameters["delays"]["imu_s"] = 11.0;
  EXPECT_THAT([&] { config_of(parameters); }, ThrowsMessage<InputError>(HasSubstr("parameter ~delays/imu_s: ")));
  parameters = with_rig();
  parameters["max_age_s"][0] = 1.0;
  EXPECT_THAT([&] { config_of(parameters); }, ThrowsMessage<InputError>(HasSubstr("parameter ~max_age_s: ")));
}

TEST(Parameters, WithoutARigTheRemedyIsSaid) {
  EXPECT_THAT([] { config_of({}); }, ThrowsMessage<InputError>(HasSubstr("parameter ~rig is missing")));
}

}  // namespace
}  // namespace edged::ros1
