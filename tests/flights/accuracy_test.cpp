// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The whole system on simulated flights. bench/sim_suite does the same at length, for figures rather than a verdict.
#include <gtest/gtest.h>

#include <iostream>
#include <ostream>

#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr double kDuration_s = 10.0;

struct FlightCase {
  std::string preset;
  int seed;
};
void PrintTo(const FlightCase& flight, std::ostream* out) { *out << flight.preset << ' ' << flight.seed; }

struct Bounds {
  double ate_m, scale_error;
};

/// About twice the worst of the nine flights, which stands beside each [m, share].
Bounds bounds_of(Mode mode) {
  switch (mode) {
    case Mode::Events:
      return {0.08, 0.09};  // 0.041, 0.055, both poster 2
    case Mode::Frames:
      return {0.018, 0.02};  // 0.008, 0.009, the dark left out
    case Mode::Fused:
      return {0.03, 0.025};  // 0.016, 0.012
  }
  return {};
}

class SimulatedFlight : public testing::TestWithParam<FlightCase> {};

// One test a flight, as each test is a process of its own and would render the flight again.
TEST_P(SimulatedFlight, IsFollowedInEveryMode) {
  const auto& [preset, seed] = GetParam();
  const Flight flight = simulate_flight(preset, seed, kDuration_s);
  for (const Mode mode : kAllModes) {
    SCOPED_TRACE(mode_name(mode));
    const FlightRun run = run_flight(flight.calibration, flight.measurements, mode);
    // Nearly black: it may lose its way or never find it, but then says so, and the poses it stands by are right.
    const bool blind = preset == "dark" && mode == Mode::Frames;
    if (blind && !run.statistics.first_good_s()) continue;
    const FlightScore result = score(flight, run);
    std::cout << preset << " " << seed << " " << mode_name(mode) << ": " << describe(result, run.statistics) << '\n';
    EXPECT_LT(result.max_tilt_deg, 3.0);  // 1.9
    if (blind) {
      EXPECT_LT(result.evaluation.ate_m.rmse, 0.08);  // 0.025
      continue;
    }
    EXPECT_EQ(run.statistics.last_status(), TrackingStatus::Good);
    EXPECT_EQ(run.statistics.times_lost(), 0U);
    EXPECT_GT(run.statistics.coverage(), 0.9);  // 0.96: the first 0.4 s wait for rest to be certain
    EXPECT_LT(result.evaluation.ate_m.rmse, bounds_of(mode).ate_m);
    EXPECT_NEAR(result.evaluation.scale, 1.0, bounds_of(mode).scale_error);
    EXPECT_LT(result.rms_velocity_error, 0.06);  // 0.03, events
  }
}

/// TUM-VI's lens with a quarter of its pixels. What room 1 gives through the DAVIS240C's stands above.
TEST(FisheyeFlight, IsFollowedThroughALensThatSeesBehindItself) {
  const Flight flight = simulate_flight("fisheye", 1, kDuration_s);
  ASSERT_TRUE(flight.calibration.rig.cameras[0].model.view_limit());
  for (const Mode mode : kAllModes) {
    SCOPED_TRACE(mode_name(mode));
    const FlightRun run = run_flight(flight.calibration, flight.measurements, mode);
    const FlightScore result = score(flight, run);
    std::cout << "fisheye 1 " << mode_name(mode) << ": " << describe(result, run.statistics) << '\n';
    EXPECT_EQ(run.statistics.last_status(), TrackingStatus::Good);
    EXPECT_EQ(run.statistics.times_lost(), 0U);
    EXPECT_LT(result.evaluation.ate_m.rmse, bounds_of(mode).ate_m);
    EXPECT_NEAR(result.evaluation.scale, 1.0, bounds_of(mode).scale_error);
  }
}

TEST(DescriptorFlight, IsFollowedByDescriptorsInsteadOfOpticalFlow) {
  const Flight flight = simulate_flight("room", 1, kDuration_s);
  OdometryConfig config;
  config.event_tracker.kind = config.frame_tracker.kind = TrackerKind::Descriptors;
  for (const Mode mode : {Mode::Frames, Mode::Fused}) {
    SCOPED_TRACE(mode_name(mode));
    const FlightRun run = run_flight(flight.calibration, flight.measurements, mode, config);
    const FlightScore result = score(flight, run);
    std::cout << "room 1, descriptors, " << mode_name(mode) << ": " << describe(result, run.statistics) << '\n';
    EXPECT_EQ(run.statistics.last_status(), TrackingStatus::Good);
    EXPECT_EQ(run.statistics.times_lost(), 0U);
    EXPECT_GT(run.statistics.coverage(), 0.9);
    EXPECT_LT(result.evaluation.ate_m.rmse, 0.013);    // 0.006, 0.005
    EXPECT_NEAR(result.evaluation.scale, 1.0, 0.012);  // 0.004, 0.000
  }
}

std::string name_of(const testing::TestParamInfo<FlightCase>& info) {
  return info.param.preset + "_" + std::to_string(info.param.seed);
}

INSTANTIATE_TEST_SUITE_P(, SimulatedFlight,
                         testing::Values(FlightCase{"room", 1}, FlightCase{"room", 2}, FlightCase{"room", 3},
                                         FlightCase{"poster", 1}, FlightCase{"poster", 2}, FlightCase{"poster", 3},
                                         FlightCase{"dark", 1}, FlightCase{"dark", 2}, FlightCase{"dark", 3}),
                         name_of);

}  // namespace
}  // namespace edged
