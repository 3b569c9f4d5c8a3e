// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The whole system on recordings that begin in mid-motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <ostream>
#include <string>
#include <vector>

#include "end_to_end.hpp"

namespace edged {
namespace {

struct MovingStart {
  std::string name, preset;
  int seed;
  double max_speed = 0.8;                      ///< [m/s]
  double gyro_bias = 0.012, accel_bias = 0.1;  ///< [rad/s], [m/s^2]
  double duration_s = 5.0;
};
void PrintTo(const MovingStart& start, std::ostream* out) { *out << start.name; }

class StartInMotion : public testing::TestWithParam<MovingStart> {};

TEST_P(StartInMotion, IsRightWhenItIsGood) {
  const MovingStart& how = GetParam();
  SimulatorConfig config = simulator_preset(how.preset);
  config.seed = how.seed;
  config.duration_s = how.duration_s;
  config.motion.rest_s = config.motion.blend_s = 0.0;
  config.motion.max_speed = how.max_speed;
  config.imu.gyro_bias = how.gyro_bias;
  config.imu.accel_bias = how.accel_bias;
  const Flight flight = simulate_flight(config);
  for (const Mode mode : {Mode::Events, Mode::Fused}) {
    if (how.preset == "dark" && mode == Mode::Fused) continue;
    SCOPED_TRACE(mode_name(mode));
    const FlightRun run = run_flight(flight.calibration, flight.measurements, mode);
    ASSERT_TRUE(run.statistics.first_good_s()) << run.steps.back().waiting_for;
    EXPECT_EQ(run.statistics.times_lost(), 0U);
    const FlightScore result = score(flight, run);
    std::cout << how.name << " " << mode_name(mode) << ": good after " << *run.statistics.first_good_s()
              << " s, scale of the start " << result.evaluation.start_scale << ", " << describe(result, run.statistics)
              << '\n';
    EXPECT_LT(*run.statistics.first_good_s(), how.duration_s - 1.0);
    EXPECT_NEAR(result.evaluation.start_scale, 1.0, 0.2);
    EXPECT_LT(result.evaluation.ate_m.rmse, 0.1);
    EXPECT_LT(result.max_tilt_deg, 6.0);  // 4.6, dark 38
  }
}

// Before the scale had to be known, the two slow ones started at up to 11 m/s and were called good.
INSTANTIATE_TEST_SUITE_P(Simulated, StartInMotion,
                         testing::Values(MovingStart{"slow_room", "room", 18, 0.25, 0.012, 0.1, 8.0},
                                         MovingStart{"slow_poster", "poster", 12, 0.25, 0.012, 0.1, 6.0},
                                         MovingStart{"room", "room", 33}, MovingStart{"fast", "handheld-fast", 36, 1.5},
                                         MovingStart{"dark", "dark", 37}, MovingStart{"dark_too", "dark", 38},
                                         MovingStart{"large_biases", "room", 41, 0.8, 0.1, 0.5}),
                         [](const auto& test) { return test.param.name; });

// The scale of a slow start is not certain; at rest the velocity is.
TEST(StartInMotion, IsMadeCertainByARest) {
  SimulatorConfig config = simulator_preset("room");
  config.seed = 45;
  config.duration_s = 3.0;
  config.motion.rest_s = config.motion.blend_s = 0.0;
  config.motion.max_speed = 0.2;
  config.motion.go_s = config.motion.pause_s = 1.5;
  const Flight flight = simulate_flight(config);
  const FlightRun run = run_flight(flight.calibration, flight.measurements, Mode::Events);
  std::vector<std::string> started;
  for (const Step& step : run.steps)
    if (!step.started.empty()) started.push_back(step.started);
  ASSERT_GT(started.size(), 1U);
  EXPECT_THAT(started.front(), testing::StartsWith("in motion"));
  EXPECT_EQ(started.back(), "at rest");
  EXPECT_EQ(run.steps.back().status, TrackingStatus::Good);
}

}  // namespace
}  // namespace edged
