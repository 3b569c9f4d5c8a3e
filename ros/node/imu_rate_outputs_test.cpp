// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/imu_rate_outputs.hpp"

#include <gmock/gmock.h>

#include "edged/core/check.hpp"
#include "node/node_test_support.hpp"

namespace edged::node {
namespace {

constexpr double kGyroNoise = 1e-4;

NodeConfig with_px4() {
  NodeConfig config;
  config.publish_px4 = true;
  return config;
}

Step step_at(int ms, TrackingStatus status) {
  Step step;
  step.t = step.state.t = timestamp_from_ns(std::int64_t{ms} * 1'000'000);
  step.status = status;
  return step;
}

TEST(ImuRateOutputs, GiveStatesAtEachSampleAndToPx4AtItsRateWhileThereIsAPose) {
  KeptTransport transport(Wire::Cdr);
  ImuRateOutputs outputs(transport, with_px4(), kGyroNoise);
  const std::string px4 = "/fmu/in/vehicle_visual_odometry";
  EXPECT_THAT(transport.topics,
              testing::ElementsAre("~/prediction nav_msgs/Odometry", px4 + " px4_msgs/VehicleOdometry"));
  const auto fly_a_second = [&](int first_ms) {
    transport.counts.clear();
    for (int ms = first_ms; ms < first_ms + 1000; ++ms)
      outputs.add({timestamp_from_ns(std::int64_t{ms} * 1'000'000), {0.0, 0.0, 0.1}, {0.0, 0.0, 9.81}});
  };
  fly_a_second(0);
  EXPECT_EQ(transport.counts[px4] + transport.counts["~/prediction"], 0U);
  outputs.note(step_at(999, TrackingStatus::Good), SE3(), SE3());
  fly_a_second(1000);
  EXPECT_EQ(transport.counts["~/prediction"], 1000U);
  EXPECT_NEAR(static_cast<double>(transport.counts[px4]), AutopilotConfig().rate_hz, 1.0);
  EXPECT_EQ(transport.last[px4].size(), 4U + 8 + 8 + 4 + 12 + 16 + 4 + 5 * 12 + 2);  // kind and fields, aligned
  EXPECT_EQ(outputs.newest(), timestamp_from_ns(1'999'000'000));
  const Estimate estimate = outputs.estimate_of(step_at(1500, TrackingStatus::Good));
  EXPECT_EQ(estimate.gyro_B, Eigen::Vector3d(0.0, 0.0, 0.1));
  EXPECT_NEAR(estimate.gyro_sigma, kGyroNoise * std::sqrt(1000.0), 1e-6) << "1 kHz";
  EXPECT_EQ(outputs.estimate_of(step_at(-1, TrackingStatus::Good)).gyro_B, Eigen::Vector3d::Zero());
  outputs.note(step_at(1999, TrackingStatus::Lost), SE3(), SE3());
  fly_a_second(2000);
  EXPECT_EQ(transport.counts[px4] + transport.counts["~/prediction"], 0U);
}

TEST(ImuRateOutputs, PredictNothingWhileThePlaceOfTheBaseIsUnknown) {
  KeptTransport transport(Wire::Cdr);
  ImuRateOutputs outputs(transport, NodeConfig(), kGyroNoise);
  outputs.add({timestamp_from_ns(0), {0.0, 0.0, 0.1}, {0.0, 0.0, 9.81}});
  outputs.note(step_at(0, TrackingStatus::Good), SE3(), std::nullopt);
  outputs.add({timestamp_from_ns(1'000'000), {0.0, 0.0, 0.1}, {0.0, 0.0, 9.81}});
  EXPECT_EQ(transport.counts["~/prediction"], 0U);
}

TEST(ImuRateOutputs, OfRos1HaveNoTopicOfPx4) {
  KeptTransport transport(Wire::Ros1);
  EXPECT_THROW(ImuRateOutputs(transport, with_px4(), kGyroNoise), InputError);
  transport.topics.clear();
  EXPECT_NO_THROW(ImuRateOutputs(transport, NodeConfig(), kGyroNoise));
  EXPECT_THAT(transport.topics, testing::ElementsAre("~/prediction nav_msgs/Odometry"));
}

}  // namespace
}  // namespace edged::node
