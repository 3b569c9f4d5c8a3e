// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/simulated_pair.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include <map>
#include <tuple>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

SimulatorConfig short_flight() {
  SimulatorConfig config;
  config.duration_s = 1.5;
  config.motion.rest_s = 0.2;
  return config;
}

TEST(SimulatedPair, GivesTheStreamsOfFourCamerasInTheOrderOfADataset) {
  SimulatedPair pair(short_flight());
  std::map<std::string, std::size_t> counts;
  Timestamp before = Timestamp::min(), last_event = Timestamp::min();
  while (const auto m = pair.next()) {
    EXPECT_GE(*first_stamp(*m), before);
    before = *first_stamp(*m);
    if (const auto* batch = std::get_if<EventBatch>(&*m)) {
      counts[batch->camera] += batch->events.size();
      last_event = std::max(last_event, batch->events.back().t);
    } else {
      EXPECT_GE(before, last_event) << "no batch goes on beyond another measurement";
      ++counts[std::holds_alternative<Frame>(*m) ? std::get<Frame>(*m).camera : "imu"];
    }
  }
  EXPECT_EQ(counts.size(), 5U);
  EXPECT_EQ(counts["frames"], counts["frames2"]);
  EXPECT_GT(counts["frames"], 20U);
  EXPECT_NEAR(static_cast<double>(counts["events2"]), static_cast<double>(counts["events"]),
              0.5 * static_cast<double>(counts["events"]));
}

TEST(SimulatedPair, IsTheSimulatorAndAnotherBesideIt) {
  SimulatedPair pair(short_flight());
  Simulator alone(short_flight());
  std::size_t imu = 0, imu_of_pair = 0, events = 0, events_of_pair = 0;
  double grey = 0.0, grey_of_pair = 0.0;
  const auto count = [](const Measurement& m, std::size_t& samples, std::size_t& all, double& sum) {
    samples += std::holds_alternative<ImuSample>(m);
    if (const auto* batch = std::get_if<EventBatch>(&m)) all += batch->camera == "events" ? batch->events.size() : 0;
    if (const auto* frame = std::get_if<Frame>(&m)) sum += frame->camera == "frames" ? cv::sum(frame->image)[0] : 0.0;
  };
  while (const auto m = alone.next()) count(*m, imu, events, grey);
  while (const auto m = pair.next()) count(*m, imu_of_pair, events_of_pair, grey_of_pair);
  EXPECT_EQ(std::tie(imu_of_pair, events_of_pair, grey_of_pair), std::tie(imu, events, grey));
  const Rig rig = pair.calibration().rig;
  ASSERT_EQ(rig.cameras.size(), 4U);
  const SE3 T_C_M = rig.camera("frames").T_B_C.inverse() * rig.camera("frames2").T_B_C;
  EXPECT_NEAR((T_C_M.translation() - Eigen::Vector3d(0.1, 0, 0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace edged
