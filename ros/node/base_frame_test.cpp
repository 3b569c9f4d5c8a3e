// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/base_frame.hpp"

#include <gmock/gmock.h>

#include "edged/core/check.hpp"
#include "node/messages.hpp"
#include "node/node_test_support.hpp"

namespace edged::node {
namespace {

using ::testing::ThrowsMessage;

SE3 shifted(double x) { return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}; }

NodeConfig on_robot(const std::string& body_pose = "") {
  NodeConfig config;
  config.frames.base = "base_link";
  config.frames.body = "imu_link";
  config.body_pose = body_pose;
  return config;
}

class StaticTransformsOfRobots : public ::testing::TestWithParam<Wire> {};
INSTANTIATE_TEST_SUITE_P(Wires, StaticTransformsOfRobots, ::testing::Values(Wire::Ros1, Wire::Cdr));

TEST_P(StaticTransformsOfRobots, TellWhereTheBaseIs) {
  KeptTransport transport(GetParam());
  const BaseFrame base(transport, on_robot());
  EXPECT_FALSE(base.on_body());
  EXPECT_THAT(base.waiting_for(), testing::HasSubstr("base_link to imu_link on /tf_static"));
  const auto send = [&](const std::vector<FrameTransform>& transforms) {
    const std::string message = transforms_message(GetParam(), Timestamp(), transforms);
    transport.receivers.at("/tf_static")({"tf2_msgs/TFMessage", "", as_bytes(message)});
  };
  // Two branches of one tree, which come in two messages.
  send({{"base_footprint", "base_link", shifted(0.1)}, {"head", "imu_link", shifted(0.3)}});
  EXPECT_FALSE(base.on_body());
  send({{"base_footprint", "head", shifted(1.0)}});
  ASSERT_TRUE(base.on_body());
  EXPECT_NEAR(base.on_body()->translation().x(), 0.1 - 1.3, 1e-12);
  EXPECT_EQ(base.waiting_for(), "");
  EXPECT_FALSE(base.given());
}

TEST(StaticTransforms, InACircleOrDamagedJoinNothing) {
  StaticTransforms transforms;
  const std::string circle =
      transforms_message(Wire::Cdr, Timestamp(), std::vector<FrameTransform>{{"a", "b", SE3()}, {"b", "a", SE3()}});
  transforms.add(Wire::Cdr, as_bytes(circle));
  EXPECT_FALSE(transforms.find("c", "a"));
  for (std::size_t size = 0; size < circle.size(); ++size) {
    StaticTransforms cut;
    cut.add(Wire::Cdr, as_bytes(circle).first(size));
    EXPECT_FALSE(cut.find("b", "a") && cut.find("c", "a"));
  }
}

TEST(BaseFrame, IsTheBodyUnlessItIsNamed) {
  KeptTransport transport(Wire::Cdr);
  const BaseFrame base(transport, NodeConfig());
  EXPECT_EQ(base.on_body()->translation(), Eigen::Vector3d::Zero());
  EXPECT_TRUE(transport.receivers.empty());
}

TEST(BaseFrame, MayBeGivenAsStaticTransformPublisherHasIt) {
  KeptTransport transport(Wire::Cdr);
  const BaseFrame base(transport, on_robot("0.2 0 0.1 0 0 1.5707963267948966"));
  ASSERT_TRUE(base.given());
  EXPECT_TRUE((*base.given() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(0.2, 1.0, 0.1)));
  EXPECT_TRUE((*base.on_body() * *base.given()).translation().isZero(1e-12));
  EXPECT_TRUE(transport.receivers.empty());
}

TEST(BaseFrame, RefusesAPoseThatIsNone) {
  KeptTransport transport(Wire::Cdr);
  for (const char* text : {"1 2 3", "0 0 0 0 0 0 7", "0 0 0 0 0 x", "nan 0 0 0 0 0"})
    EXPECT_THAT([&] { BaseFrame(transport, on_robot(text)); },
                ThrowsMessage<InputError>("body_pose '" + std::string(text) +
                                          "': give six numbers, x y z [m] roll pitch yaw [rad]"));
  NodeConfig config;
  config.body_pose = "0 0 0 0 0 0";
  EXPECT_THAT([&] { BaseFrame(transport, config); },
              ThrowsMessage<InputError>("body_pose is the pose of the IMU in base_frame: set base_frame, too"));
}

}  // namespace
}  // namespace edged::node
