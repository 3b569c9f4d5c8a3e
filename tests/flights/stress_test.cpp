// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is expected of each disturbance, on one short recording each. tests/stress does the same at length: full
// lengths, several seeds, every mode.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr double kAt_s = 3.0, kAfter_s = 3.0;

Flight disturbed_flight(DisturbanceKind kind, double length_s, const std::vector<std::string>& settings = {}) {
  SimulatorConfig config;
  config.disturbance.kind = kind;
  config.disturbance.at_s = kAt_s;
  config.disturbance.length_s = length_s;
  config.duration_s = kAt_s + length_s + kAfter_s;
  ConfigFields fields = ConfigFields::of(config);
  for (const std::string& setting : settings) fields.set(setting);
  return simulate_flight(config);
}

/// Disturbed all along, or in motion from its first moment: the preset says how, and the settings.
Flight flight_of(const std::string& preset, double duration_s, const std::vector<std::string>& settings = {}) {
  SimulatorConfig config = simulator_preset(preset);
  config.duration_s = duration_s;
  ConfigFields fields = ConfigFields::of(config);
  for (const std::string& setting : settings) fields.set(setting);
  return simulate_flight(config);
}

bool ever(const FlightRun& run, TrackingStatus status) {
  const auto first_good = std::find_if(run.steps.begin(), run.steps.end(),
                                       [](const Step& step) { return step.status == TrackingStatus::Good; });
  return std::any_of(first_good, run.steps.end(), [=](const Step& step) { return step.status == status; });
}

bool stays_good(const FlightRun& run) {
  return !ever(run, TrackingStatus::Degraded) && !ever(run, TrackingStatus::Lost) &&
         !ever(run, TrackingStatus::Initializing);
}

/// Runs it and holds it to what is expected of every disturbance: Good at the end, time never runs backwards, no silent
/// divergence.
FlightRun withstand(const Flight& flight, Mode mode) {
  FlightRun run = run_flight(flight.calibration, flight.measurements, mode);
  if (!run.statistics.first_good_s()) {
    ADD_FAILURE() << mode_name(mode) << ": never good, waits for " << run.steps.back().waiting_for;
    return run;
  }
  const FlightScore result = score(flight, run);
  std::cout << mode_name(mode) << ": " << describe(result, run.statistics) << '\n';
  EXPECT_EQ(run.statistics.last_status(), TrackingStatus::Good);
  for (std::size_t i = 1; i < run.steps.size(); ++i) EXPECT_LT(run.steps[i - 1].state.t, run.steps[i].state.t);
  EXPECT_TRUE(result.evaluation.mpe_percent < 5.0 || run.statistics.times_lost() > 0);
  for (const TimeSpan& span : result.consistency.silent) {
    std::cout << "Good, but beyond its 3 sigma from " << to_seconds(span.begin) << " to " << to_seconds(span.end)
              << '\n';
  }
  EXPECT_TRUE(result.consistency.silent.empty());
  return run;
}

/// The same, Good in time, and never lost.
FlightRun start_and_withstand(const Flight& flight, Mode mode, double within_s) {
  FlightRun run = withstand(flight, mode);
  EXPECT_LT(run.statistics.first_good_s().value_or(1e9), within_s) << mode_name(mode);
  EXPECT_EQ(run.statistics.times_lost(), 0U) << mode_name(mode);
  return run;
}

TEST(Stress, ALensCoveredForTwoSecondsDegradesAndIsGoodAgain) {
  const Flight flight = disturbed_flight(DisturbanceKind::LensCovered, 2.0);
  for (const Mode mode : {Mode::Fused, Mode::Events}) {
    const FlightRun run = withstand(flight, mode);
    EXPECT_TRUE(ever(run, TrackingStatus::Degraded));
    EXPECT_EQ(run.statistics.times_lost(), 0U);
  }
}

TEST(Stress, EventsCarryOnWhenTheLightsGoOffAndOn) {
  const Flight flight = disturbed_flight(DisturbanceKind::LightsOff, 2.0);
  EXPECT_TRUE(stays_good(withstand(flight, Mode::Fused)));
  EXPECT_EQ(withstand(flight, Mode::Events).statistics.times_lost(), 0U);
}

TEST(Stress, FiveSecondsWithoutFramesStayGoodByTheEventsAndComeBackWithoutThem) {
  const Flight flight = disturbed_flight(DisturbanceKind::FramesMissing, 5.0);
  EXPECT_TRUE(stays_good(withstand(flight, Mode::Fused)));
  withstand(flight, Mode::Frames);
}

TEST(Stress, ASecondWithoutEventsStaysGoodByTheFramesAndIsSurvivedWithoutThem) {
  const Flight flight = disturbed_flight(DisturbanceKind::EventsMissing, 1.0);
  EXPECT_TRUE(stays_good(withstand(flight, Mode::Fused)));
  EXPECT_EQ(withstand(flight, Mode::Events).statistics.times_lost(), 0U);
}

TEST(Stress, AThirdOfASecondWithoutImuIsSurvived) {
  const Flight flight = disturbed_flight(DisturbanceKind::ImuGap, 0.3);
  for (const Mode mode : kAllModes) EXPECT_EQ(withstand(flight, mode).statistics.times_lost(), 0U);
}

/// Without a gyro frames tell the motion, event frames do not.
TEST(Stress, TwoSecondsWithoutImuAreBridgedByTheFramesAndEndEventsAlone) {
  Flight flight = flight_of("poster", 13.0);
  std::erase_if(flight.measurements, [](const Measurement& measurement) {
    const auto* sample = std::get_if<ImuSample>(&measurement);
    return sample != nullptr && to_seconds(sample->t) > 8.0 && to_seconds(sample->t) < 10.0;
  });
  for (const Mode mode : {Mode::Fused, Mode::Frames}) {
    const FlightRun run = withstand(flight, mode);
    EXPECT_EQ(run.statistics.times_lost(), 0U);
    EXPECT_LT(score(flight, run).evaluation.mpe_percent, 1.0);
  }
  const FlightRun events = run_flight(flight.calibration, flight.measurements, Mode::Events);
  EXPECT_TRUE(std::ranges::all_of(events.steps, [](const Step& step) {
    return to_seconds(step.t) < 9.1 || to_seconds(step.t) > 10.0 || step.status == TrackingStatus::Lost;
  }));
}

/// Of the position [m].
double largest_sigma_while_good(const FlightRun& run) {
  double largest = 0.0;
  for (const Step& step : run.steps)
    if (step.status == TrackingStatus::Good && step.covariance)
      largest = std::max(largest, std::sqrt(step.covariance->position.diagonal().maxCoeff()));
  return largest;
}

/// Tracks that survive bridge half a second; after two the body is relocalized, also so soon that there was no map yet.
TEST(Stress, ASilenceOfAllSensorsIsSurvived) {
  const Flight whole = flight_of("poster", 13.0);
  for (const auto& [at_s, length_s] : {std::pair(8.0, 0.5), {8.0, 2.0}, {2.5, 2.0}}) {
    SCOPED_TRACE(testing::Message() << at_s << " s, for " << length_s << " s");
    Flight flight = whole;
    std::erase_if(flight.measurements, [&](const Measurement& measurement) {
      const double t = to_seconds(last_stamp(measurement).value_or(Timestamp()));
      return t > at_s && t < at_s + length_s;
    });
    for (const Mode mode : {Mode::Fused, Mode::Frames}) {
      const FlightRun run = withstand(flight, mode);
      EXPECT_EQ(run.statistics.times_lost(), length_s > 1.0 ? 1U : 0U);
      EXPECT_LT(largest_sigma_while_good(run), StatusConfig().max_place_sigma);
    }
  }
}

TEST(Stress, ATurnBeyondTheGyrosRangeIsSurvived) {
  const Flight flight = disturbed_flight(DisturbanceKind::GyroSaturation, 1.0, {"imu.gyro_range=4.363"});
  EXPECT_EQ(withstand(flight, Mode::Fused).statistics.times_lost(), 0U);
}

TEST(Stress, AShakeThatBlursTheFramesIsSurvived) {
  const Flight flight =
      disturbed_flight(DisturbanceKind::Shake, 1.0, {"frames.exposure_ms=20", "frames.electrons_per_ms=1000"});
  EXPECT_EQ(withstand(flight, Mode::Fused).statistics.times_lost(), 0U);
}

TEST(Stress, APersonWhoWalksThroughTheViewDoesNotPullTheEstimateAlong) {
  const Flight flight = disturbed_flight(DisturbanceKind::Person, 2.5);
  for (const Mode mode : kAllModes) EXPECT_TRUE(stays_good(withstand(flight, mode)));
}

TEST(Stress, ABlankWallIsNotCalledGoodAndIsLeftAgain) {
  const Flight flight = disturbed_flight(DisturbanceKind::BlankWall, 3.0, {"disturbance.at_s=4.5", "duration_s=12.5"});
  EXPECT_FALSE(stays_good(withstand(flight, Mode::Fused)));
}

TEST(Stress, PureRotationStaysGood) {
  const Flight flight = disturbed_flight(DisturbanceKind::PureRotation, 4.0);
  for (const Mode mode : kAllModes) EXPECT_TRUE(stays_good(withstand(flight, mode)));
}

/// Largest way of the estimate from where it was at the first of two times.
double drift_m(const FlightRun& run, double from_s, double to_s) {
  std::optional<Eigen::Vector3d> first;
  double furthest = 0.0;
  for (const Step& step : run.steps) {
    if (to_seconds(step.state.t) < from_s || to_seconds(step.state.t) > to_s) continue;
    if (!first) first = step.state.T_W_B.translation();
    furthest = std::max(furthest, (step.state.T_W_B.translation() - *first).norm());
  }
  return furthest;
}

constexpr double kStandstill_s = 8.0;  // a minute in tests/stress

TEST(Stress, AStandstillDriftsByLessThanACentimetre) {
  const Flight flight = disturbed_flight(DisturbanceKind::Standstill, kStandstill_s);
  for (const Mode mode : kAllModes) {
    const FlightRun run = withstand(flight, mode);
    EXPECT_TRUE(stays_good(run));
    // Without frames, rest is recognised after half a second, and corrects what little the events of two seconds told:
    // that is no drift.
    const double from_s = kAt_s + (mode == Mode::Events ? 1.2 : 0.2);
    EXPECT_LT(drift_m(run, from_s, kAt_s + kStandstill_s), 0.01) << mode_name(mode);
  }
}

TEST(Stress, AStormOfTwentyMillionEventsASecondIsSurvived) {
  const Flight flight = disturbed_flight(DisturbanceKind::EventStorm, 0.3);
  EXPECT_TRUE(stays_good(withstand(flight, Mode::Fused)));
  EXPECT_EQ(withstand(flight, Mode::Events).statistics.times_lost(), 0U);
}

constexpr double kFromRest_s = 1.5, kInMotion_s = 3.0;  // until Good
const std::vector<std::string> kInMotion{"motion.rest_s=0", "motion.blend_s=0"};
// A mean of 7 of some 22 grey levels, a read noise of 1.2 of them.
const std::vector<std::string> kDim{"frames.electrons_per_ms=225", "frames.read_noise_electrons=96"};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Stress, AStartAmongWalkersIsGoodAndStaysIt) {
  const Flight flight = flight_of("walkers", 6.0);
  for (const Mode mode : kAllModes) EXPECT_TRUE(stays_good(start_and_withstand(flight, mode, kFromRest_s)));
}

TEST(Stress, WalkersWhoFillMostOfTheViewDoNotPullTheEstimateAlong) {
  const Flight flight = flight_of("walkers", 6.0, {"disturbance.strength=1"});
  for (const Mode mode : kAllModes) start_and_withstand(flight, mode, kFromRest_s);
}

TEST(Stress, ALampThatWandersOverADarkRoomIsNoMotion) {
  const Flight flight = flight_of("spot", 6.0);
  for (const Mode mode : kAllModes) start_and_withstand(flight, mode, kFromRest_s);
}

TEST(Stress, ALampThatIsSwitchedInADarkRoomIsNoMotion) {
  const Flight flight = flight_of("spot", 6.0, {"disturbance.kind=switching-lamp"});
  for (const Mode mode : kAllModes) start_and_withstand(flight, mode, kFromRest_s);
}

bool good_between(const FlightRun& run, double from_s, double to_s) {
  return std::all_of(run.steps.begin(), run.steps.end(), [=](const Step& step) {
    const double t_s = to_seconds(step.state.t);
    return t_s < from_s || t_s > to_s || step.status == TrackingStatus::Good;
  });
}

TEST(Stress, BeingPutDownAndPickedUpIsNoContradiction) {
  constexpr double kRest_s = 5.0;  // ten in tests/stress
  const Flight flight =
      disturbed_flight(DisturbanceKind::PutDown, kRest_s, {"disturbance.strength=4", "imu.rate_hz=200"});
  for (const Mode mode : kAllModes) {
    const FlightRun run = start_and_withstand(flight, mode, kFromRest_s);
    EXPECT_LT(drift_m(run, kAt_s + 1.2, kAt_s + kRest_s), 0.01) << mode_name(mode);
    for (const double knock_s : {kAt_s, kAt_s + kRest_s})
      EXPECT_TRUE(good_between(run, knock_s + 1.0, knock_s + 2.0))
          << mode_name(mode) << ", knock at " << knock_s << " s";
  }
}

TEST(Stress, TenRadiansASecondAreSurvived) {
  const Flight flight = flight_of("handheld-wild", 4.0);
  for (const Mode mode : kAllModes) start_and_withstand(flight, mode, kFromRest_s);
}

TEST(Stress, AStartInWildRotationIsGoodSoonAndRight) {
  const Flight flight = flight_of("handheld-wild", 4.0, kInMotion);
  for (const Mode mode : kAllModes) start_and_withstand(flight, mode, kInMotion_s);
}

TEST(Stress, TwoMillionNoiseEventsASecondAreSurvivedFromTheStart) {
  const Flight flight = flight_of(
      "room", 6.0,
      {"disturbance.kind=event-storm", "disturbance.at_s=0", "disturbance.length_s=6", "disturbance.strength=2"});
  EXPECT_TRUE(stays_good(start_and_withstand(flight, Mode::Fused, kFromRest_s)));
  start_and_withstand(flight, Mode::Events, kFromRest_s);
}

TEST(Stress, ALampOnMainsIsNoMotion) {
  const Flight flight = flight_of("room", 6.0, {"disturbance.kind=flicker", "disturbance.at_s=0"});
  for (const Mode mode : {Mode::Events, Mode::Fused})
    EXPECT_TRUE(stays_good(start_and_withstand(flight, mode, kFromRest_s))) << mode_name(mode);
}

TEST(Stress, FramesOfTwentyGreyLevelsSuffice) {
  const Flight flight = flight_of("room", 6.0, kDim);
  for (const Mode mode : {Mode::Frames, Mode::Fused})
    EXPECT_TRUE(stays_good(start_and_withstand(flight, mode, kFromRest_s)));
}

TEST(Stress, FramesOfTwentyGreyLevelsSufficeForAStartInMotion) {
  const Flight flight = flight_of("room", 6.0, kDim + kInMotion);
  for (const Mode mode : {Mode::Frames, Mode::Fused}) start_and_withstand(flight, mode, kInMotion_s);
}

}  // namespace
}  // namespace edged
