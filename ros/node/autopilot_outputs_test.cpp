// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/autopilot_outputs.hpp"

#include <gmock/gmock.h>

#include "edged/core/check.hpp"
#include "node/node_test_support.hpp"

namespace edged::node {
namespace {

NodeConfig with_px4() {
  NodeConfig config;
  config.publish_px4 = true;
  return config;
}

Step good_step(Timestamp t) {
  Step step;
  step.t = step.state.t = t;
  step.status = TrackingStatus::Good;
  return step;
}

TEST(AutopilotOutputs, GivePx4StatesAtTheRateOfTheOptionsWhileThereIsAPose) {
  KeptTransport transport(Wire::Cdr);
  AutopilotOutputs outputs(transport, with_px4());
  EXPECT_THAT(transport.topics, testing::ElementsAre("/fmu/in/vehicle_visual_odometry px4_msgs/VehicleOdometry"));
  const auto send_for_a_second = [&](int first_ms) {
    transport.messages.clear();
    for (int ms = first_ms; ms < first_ms + 1000; ++ms) {
      NavState state;
      state.t = timestamp_from_ns(std::int64_t{ms} * 1'000'000);
      outputs.send(state, {state.t});
    }
    return static_cast<double>(transport.messages.size());
  };
  EXPECT_EQ(send_for_a_second(0), 0.0);
  outputs.note(good_step(timestamp_from_ns(1'000'000'000)));
  EXPECT_NEAR(send_for_a_second(1000), AutopilotConfig().rate_hz, 1.0);
  EXPECT_EQ(transport.messages.front().size(), 4U + 8 + 8 + 4 + 12 + 16 + 4 + 5 * 12 + 2);  // kind and fields, aligned
  Step lost = good_step(timestamp_from_ns(2'000'000'000));
  lost.status = TrackingStatus::Lost;
  outputs.note(lost);
  EXPECT_EQ(send_for_a_second(2000), 0.0);
}

TEST(AutopilotOutputs, OfRos1HaveNoTopicOfPx4) {
  KeptTransport transport(Wire::Ros1);
  EXPECT_THROW(AutopilotOutputs(transport, with_px4()), InputError);
  EXPECT_NO_THROW(AutopilotOutputs(transport, NodeConfig()));
  EXPECT_THAT(transport.topics, testing::IsEmpty());
}

}  // namespace
}  // namespace edged::node
