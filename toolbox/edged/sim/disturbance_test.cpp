// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/disturbance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "edged/core/check.hpp"
#include "edged/sim/motion/test_derivatives.hpp"
#include "edged/sim/sensors/renderer.hpp"
#include "edged/sim/test_recording.hpp"

namespace edged {
namespace {

constexpr double kAt_s = 1.0;

SimulatorConfig disturbed(const std::string& kind, double length_s, double after_s = 0.4) {
  SimulatorConfig config = small("room", kAt_s + length_s + after_s);
  ConfigFields fields = ConfigFields::of(config);
  fields.set("disturbance.kind", kind);
  fields.set("disturbance.at_s", std::to_string(kAt_s));
  fields.set("disturbance.length_s", std::to_string(length_s));
  return config;
}

SimulatorConfig undisturbed(SimulatorConfig config) {
  config.disturbance.kind = DisturbanceKind::None;
  return config;
}

/// The event rate between two times.
double event_rate(const Recorded& recorded, double from_s, double to_s) {
  const auto within = [=](const Event& e) { return to_seconds(e.t) >= from_s && to_seconds(e.t) < to_s; };
  return static_cast<double>(std::count_if(recorded.events.begin(), recorded.events.end(), within)) / (to_s - from_s);
}

std::vector<cv::Mat> frames(const Recorded& recorded, double from_s, double to_s) {
  std::vector<cv::Mat> images;
  for (const Frame& frame : recorded.frames)
    if (to_seconds(frame.t) >= from_s && to_seconds(frame.t) < to_s) images.push_back(frame.image);
  return images;
}

/// The elements of `all` outside the disturbance.
template <typename Sample>
std::vector<Sample> without(std::vector<Sample> all, double from_s, double to_s, Duration offset = Duration(0)) {
  std::erase_if(all, [=](const Sample& s) {
    return to_seconds(s.t - offset) >= from_s - 1e-9 && to_seconds(s.t - offset) < to_s - 1e-9;
  });
  return all;
}

constexpr double kNoise_hz = 0.2 * 120 * 90;  // of all pixels, leak included

TEST(Disturbance, ThereIsNoneByDefaultAndItsTimesThenMeanNothing) {
  SimulatorConfig config = small("room", 0.8);
  const Recorded plain = record(config);
  ConfigFields::of(config).set("disturbance.at_s=0.1");
  ConfigFields::of(config).set("disturbance.length_s=9");
  EXPECT_TRUE(same(plain, record(config)));
}

TEST(Disturbance, HasAUsualLengthAndStrengthForEveryKind) {
  for (int kind = 1; kind <= static_cast<int>(DisturbanceKind::Flicker); ++kind) {
    Disturbance disturbance;
    disturbance.kind = static_cast<DisturbanceKind>(kind);
    EXPECT_GT(disturbance.filled_in(30.0).length_s, 0.0) << kind;
    disturbance.length_s = 0.7, disturbance.strength = 0.6;
    EXPECT_EQ(disturbance.filled_in(30.0).length_s, 0.7);
    EXPECT_EQ(disturbance.filled_in(30.0).strength, 0.6);
  }
}

TEST(Disturbance, IsRefusedWhereItCannotBe) {
  SimulatorConfig late = disturbed("standstill", 0.0);
  EXPECT_THROW(Simulator{late}, InputError);  // lasts 60 s
  SimulatorConfig wall = disturbed("blank-wall", 1.0);
  wall.scene.kind = SceneKind::Poster;
  EXPECT_THROW(Simulator{wall}, InputError);
}

TEST(LensCovered, MakesFramesBlackAndGivesEventsOnlyAtItsEnds) {
  const Recorded recorded = record(disturbed("lens-covered", 0.8));
  const double usual = event_rate(recorded, 0.6, 1.0);
  EXPECT_GT(event_rate(recorded, 1.0, 1.06), 5.0 * usual);
  EXPECT_LT(event_rate(recorded, 1.07, 1.8), kNoise_hz);
  EXPECT_GT(event_rate(recorded, 1.8, 1.86), 5.0 * usual);
  const auto black = frames(recorded, 1.08, 1.79);
  ASSERT_GT(black.size(), 15U);
  for (const cv::Mat& image : black) EXPECT_LT(cv::mean(image)[0], 2.0);
  for (const cv::Mat& image : frames(recorded, 1.9, 2.2)) EXPECT_GT(cv::mean(image)[0], 40.0);
}

TEST(LightsOff, LeavesATraceOfLightAndTheSceneInTheEvents) {
  const SimulatorConfig config = disturbed("lights-off", 0.8);
  const Recorded recorded = record(config);
  const Recorded bright = record(undisturbed(config));
  const auto dark_frames = frames(recorded, 1.05, 1.78), bright_frames = frames(bright, 1.05, 1.78);
  ASSERT_EQ(dark_frames.size(), bright_frames.size());
  for (std::size_t i = 0; i < dark_frames.size(); ++i)
    EXPECT_NEAR(cv::mean(dark_frames[i])[0], 0.03 * cv::mean(bright_frames[i])[0] + 0.4, 0.6);
  EXPECT_GT(event_rate(recorded, 1.05, 1.78), 4.0 * kNoise_hz);
  EXPECT_LT(event_rate(recorded, 1.05, 1.78), event_rate(bright, 1.05, 1.78));
}

TEST(FramesMissing, TakesAwayNothingButFrames) {
  const SimulatorConfig config = disturbed("frames-missing", 0.5);
  Recorded expected = record(undisturbed(config));
  const std::size_t all = expected.frames.size();
  expected.frames = without(expected.frames, 1.0, 1.5);
  EXPECT_EQ(all - expected.frames.size(), 12U);
  EXPECT_TRUE(same(record(config), expected));
}

TEST(EventsMissing, TakesAwayNothingButEvents) {
  const SimulatorConfig config = disturbed("events-missing", 0.5);
  Recorded expected = record(undisturbed(config));
  EXPECT_GT(event_rate(expected, 1.0, 1.5), 1e4);
  expected.events = without(expected.events, 1.0, 1.5);
  EXPECT_TRUE(same(record(config), expected));
}

TEST(ImuGap, TakesAwayNothingButImuSamples) {
  const SimulatorConfig config = disturbed("imu-gap", 0.3);
  Recorded expected = record(undisturbed(config));
  expected.imu = without(expected.imu, 1.0, 1.3, duration_from_seconds(2.4e-3));
  const Recorded recorded = record(config);
  EXPECT_TRUE(same(recorded, expected));
  Duration longest{0};
  for (std::size_t i = 1; i < recorded.imu.size(); ++i)
    longest = std::max(longest, recorded.imu[i].t - recorded.imu[i - 1].t);
  EXPECT_EQ(longest, std::chrono::milliseconds(301));
}

TEST(GyroSaturation, HoldsTheGyroAtItsRangeInATurnThatComesBack) {
  SimulatorConfig config = disturbed("gyro-saturation", 1.0);
  config.imu.gyro_range = 4.0;
  const Recorded recorded = record(config);
  const auto saturated = [](const ImuSample& s) { return std::abs(s.gyro_B.y()) == 4.0; };
  EXPECT_NEAR(static_cast<double>(std::count_if(recorded.imu.begin(), recorded.imu.end(), saturated)), 500.0, 120.0);
  const Simulator simulator(config), plain(undisturbed(config));
  EXPECT_GT(simulator.trajectory().at(1.25).omega_B.norm(), 5.0);
  for (const double t : {0.9, 2.1})
    EXPECT_EQ(simulator.trajectory().at(t).T_W_B.rotation().coeffs(),
              plain.trajectory().at(t).T_W_B.rotation().coeffs());
}

TEST(Shake, BlursFramesByQuickTurnsToAndFro) {
  SimulatorConfig config = disturbed("shake", 0.6);
  const Recorded shaken = record(config), calm = record(undisturbed(config));
  double peak = 0.0, share = 0.0;
  for (const ImuSample& sample : shaken.imu) peak = std::max(peak, sample.gyro_B.norm());
  EXPECT_NEAR(peak, 400.0 * std::numbers::pi / 180.0, 1.5);
  const auto blurred = frames(shaken, 1.2, 1.4), sharp = frames(calm, 1.2, 1.4);
  for (std::size_t i = 0; i < blurred.size(); ++i) share += sharpness(blurred[i]) / sharpness(sharp[i]);
  EXPECT_LT(share / static_cast<double>(blurred.size()), 0.7);
  EXPECT_GT(event_rate(shaken, 1.2, 1.4), 3.0 * event_rate(calm, 1.2, 1.4));
}

/// Share of the pixels where the two scenes differ.
double differing_share(const Rendering& a, const Rendering& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.inverse_depth.size(); ++i) count += a.inverse_depth[i] != b.inverse_depth[i] ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(a.inverse_depth.size());
}

/// The share of the view that the disturbance covers, by the time [s].
std::map<double, double> covered_shares(const SimulatorConfig& config) {
  const Simulator acting(config), calm(undisturbed(config));
  Renderer with(config.camera.model(), acting.scene()), without(config.camera.model(), calm.scene());
  std::map<double, double> shares;
  for (double t = 0.0; t < config.duration_s; t += 1.0 / config.frames.rate_hz) {
    const SE3 T_W_C = acting.trajectory().at(t).T_W_B * config.T_B_C;
    shares[t] = differing_share(with.render(T_W_C, t), without.render(T_W_C, t));
  }
  return shares;
}

double largest_between(const std::map<double, double>& shares, double from_s, double to_s) {
  double largest = 0.0;
  for (const auto& [t, share] : shares)
    if (t >= from_s && t < to_s) largest = std::max(largest, share);
  return largest;
}

TEST(Person, FillsAThirdToTwoThirdsOfTheViewInPassing) {
  const double largest = largest_between(covered_shares(disturbed("person", 2.5)), 0.0, 10.0);
  EXPECT_GT(largest, 0.3);
  EXPECT_LT(largest, 0.65);
}

TEST(Person, WalksSoThatThePicturesMoveByNoMoreThanAllowed) {
  SimulatorConfig config = disturbed("person", 2.5);
  Simulator simulator(config);
  while (simulator.rendered_until() < timestamp_from_seconds(2.25)) ASSERT_TRUE(simulator.next());
  const std::size_t before = simulator.renderings();
  const double from_s = to_seconds(simulator.rendered_until());
  while (simulator.rendered_until() < timestamp_from_seconds(2.35)) ASSERT_TRUE(simulator.next());
  // 0.65 m/s seen from 0.85 m with a focal length of 100 px.
  const double person_px = 0.65 / 0.85 * 100.0 * (to_seconds(simulator.rendered_until()) - from_s);
  EXPECT_GT(static_cast<double>(simulator.renderings() - before), person_px / config.max_motion_px);
}

TEST(Walkers, CoverTheirShareOfTheViewWhileTheCameraRests) {
  for (const double strength : {0.3, 0.7}) {
    SimulatorConfig config = disturbed("walkers", 0.0, 3.5);
    config.motion.rest_s = config.duration_s;
    config.disturbance.at_s = 0.0, config.disturbance.strength = strength;
    const std::map<double, double> shares = covered_shares(config);
    EXPECT_NEAR(largest_between(shares, 0.0, 5.0), strength, 0.3 * strength);
    // The view is never without them for long.
    for (const double t : {0.0, 1.2, 2.4}) EXPECT_GT(largest_between(shares, t, t + 1.2), 0.25 * strength);
    EXPECT_GT(event_rate(record(config), 0.2, 4.0), 10.0 * kNoise_hz);
  }
}

TEST(Walkers, AreAwayBeforeAndAfterTheirTime) {
  SimulatorConfig config = disturbed("walkers", 1.0, 1.5);
  config.disturbance.at_s = 1.5;
  config.motion.rest_s = config.duration_s = 4.0;
  const std::map<double, double> shares = covered_shares(config);
  EXPECT_EQ(largest_between(shares, 0.0, 0.5), 0.0);
  EXPECT_GT(largest_between(shares, 1.5, 2.5), 0.2);
  EXPECT_EQ(largest_between(shares, 3.5, 4.0), 0.0);
}

/// The centre of the pixels that are at least half as bright as the brightest one [px]. Nothing in the dark.
std::optional<Eigen::Vector2d> spot_of(const cv::Mat& image) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, cv::Size(), 4.0);
  double brightest = 0.0;
  cv::minMaxLoc(blurred, nullptr, &brightest);
  if (brightest < 60.0) return std::nullopt;
  const cv::Moments m = cv::moments(blurred > 0.5 * brightest, true);
  return Eigen::Vector2d(m.m10 / m.m00, m.m01 / m.m00);
}

SimulatorConfig lamp_over_a_dark_room(const std::string& kind) {
  SimulatorConfig config = small("spot", 3.0);
  config.motion.rest_s = config.duration_s;
  ConfigFields::of(config).set("disturbance.kind", kind);
  return config;
}

TEST(WanderingLamp, LetsABrightSpotWanderOverADarkRoomThatRests) {
  const Recorded recorded = record(lamp_over_a_dark_room("wandering-lamp"));
  Eigen::AlignedBox2d places;
  int seen = 0;
  for (const cv::Mat& image : frames(recorded, 0.0, 3.0)) {
    const auto spot = spot_of(image);
    if (!spot) continue;
    places.extend(*spot), ++seen;
    cv::Mat rest = image.clone();
    cv::circle(rest, cv::Point(static_cast<int>(spot->x()), static_cast<int>(spot->y())), 45, cv::Scalar(0), -1);
    EXPECT_LT(cv::mean(rest)[0], 25.0);
  }
  EXPECT_GT(seen, 40);  // of 72 frames: the spot is sometimes outside the view
  EXPECT_GT(places.sizes().maxCoeff(), 40.0);
  EXPECT_GT(event_rate(recorded, 0.5, 3.0), 30.0 * kNoise_hz);
}

TEST(SwitchingLamp, GoesOnAndOff) {
  const Recorded recorded = record(lamp_over_a_dark_room("switching-lamp"));
  int changes = 0;
  std::vector<bool> lit;
  for (const cv::Mat& image : frames(recorded, 0.0, 3.0)) lit.push_back(spot_of(image).has_value());
  for (std::size_t i = 1; i < lit.size(); ++i) changes += lit[i] != lit[i - 1] ? 1 : 0;
  EXPECT_GE(changes, 3);
}

TEST(BlankWall, ShowsNothingWhileTheCameraLooksAtIt) {
  const Recorded recorded = record(disturbed("blank-wall", 1.0, 1.6));
  EXPECT_LT(event_rate(recorded, 1.0, 2.0), kNoise_hz);
  EXPECT_GT(event_rate(recorded, 3.3, 3.6), 10.0 * kNoise_hz);
  const auto blank = frames(recorded, 1.0, 2.0);
  ASSERT_EQ(blank.size(), 24U);
  cv::Scalar mean, deviation;
  for (const cv::Mat& image : blank) {
    cv::meanStdDev(image, mean, deviation);
    EXPECT_LT(deviation[0], 3.0);
    EXPECT_GT(mean[0], 60.0);
  }
}

TEST(PureRotation, LeavesTheBodyWhereItIsWhileItTurns) {
  const Simulator simulator(disturbed("pure-rotation", 2.0));
  const Kinematics begin = simulator.trajectory().at(1.0), end = simulator.trajectory().at(3.0);
  EXPECT_LT((begin.T_W_B.translation() - end.T_W_B.translation()).norm(), 1e-9);
  EXPECT_GT(so3::log(begin.T_W_B.rotation().conjugate() * end.T_W_B.rotation()).norm(), 0.1);
  EXPECT_LT(simulator.trajectory().at(2.0).v_W.norm() + simulator.trajectory().at(2.0).a_W.norm(), 1e-9);
  EXPECT_GT(simulator.trajectory().at(3.4).v_W.norm(), 0.01);
}

TEST(Standstill, StopsAllMotionAndGoesOnAfterIt) {
  const SimulatorConfig config = disturbed("standstill", 1.0, 0.8);
  const Simulator simulator(config), plain(undisturbed(config));
  for (const double t : {1.0, 1.5, 2.0}) {
    const Kinematics k = simulator.trajectory().at(t);
    EXPECT_LT(k.v_W.norm() + k.a_W.norm() + k.omega_B.norm(), 1e-9);
  }
  // A stop and a start each delay by half of their duration.
  const SE3 late = simulator.trajectory().at(2.6).T_W_B, early = plain.trajectory().at(1.1).T_W_B;
  EXPECT_LT((late.translation() - early.translation()).norm(), 1e-9);
  const Recorded recorded = record(config);
  EXPECT_LT(event_rate(recorded, 1.0, 2.0), kNoise_hz);
  EXPECT_GT(event_rate(recorded, 2.5, 2.8), 4.0 * kNoise_hz);
}

TEST(PutDown, KnocksAsHardAsItSaysAndRestsInBetween) {
  for (const double strength : {1.0, 4.0}) {
    SimulatorConfig config = disturbed("put-down", 1.0, 0.8);
    config.disturbance.strength = strength;
    const Simulator simulator(config);
    // The acceleration that the knock adds, in g.
    const auto peak_g = [&](double from_s, double to_s) {
      double peak = 0.0;
      for (double t = from_s; t < to_s; t += 5e-4)
        peak = std::max(peak, std::abs(simulator.trajectory().at(t).a_W.z()));
      return peak / 9.80665;
    };
    EXPECT_NEAR(peak_g(1.0, 1.1), strength, 0.02 * strength);
    EXPECT_NEAR(peak_g(2.0, 2.02), strength, 0.05 * strength);
    for (const double t : {1.11, 1.5, 1.99}) {
      const Kinematics k = simulator.trajectory().at(t);
      EXPECT_LT(k.v_W.norm() + k.a_W.norm() + k.omega_B.norm(), 1e-9);
    }
    // The body is lowered until the contact, which yields by a few millimetres. The motion has no jump.
    const double above = simulator.trajectory().at(0.5).T_W_B.translation().z();
    const double contact = simulator.trajectory().at(1.0).T_W_B.translation().z();
    EXPECT_GT(above - contact, 0.005 * strength);
    double lowest = contact;
    for (double t = 1.0; t < 1.1; t += 1e-3)
      lowest = std::min(lowest, simulator.trajectory().at(t).T_W_B.translation().z());
    EXPECT_GT(contact - lowest, 1e-4 * strength);
    EXPECT_LT(contact - lowest, 4e-3);
  }
}

TEST(PutDown, IsCutByTheAccelerometersRange) {
  SimulatorConfig config = disturbed("put-down", 0.6, 0.6);
  config.disturbance.strength = 4.0;
  config.imu.accel_range = 25.0;
  double largest = 0.0;
  for (const ImuSample& sample : record(config).imu) largest = std::max(largest, sample.accel_B.cwiseAbs().maxCoeff());
  EXPECT_EQ(largest, 25.0);
}

TEST(EventStorm, FiresAsOftenAsItSaysAllOverTheArray) {
  const SimulatorConfig config = disturbed("event-storm", 0.1);
  const Recorded recorded = record(config), calm = record(undisturbed(config));
  EXPECT_NEAR(event_rate(recorded, 1.01, 1.09), 20e6, 1e6);
  EXPECT_NEAR(event_rate(recorded, 0.6, 1.0), event_rate(calm, 0.6, 1.0), 1.0);
  std::vector<int> counts(120 * 90, 0);
  for (const Event& event : recorded.events)
    if (event.t >= timestamp_from_seconds(1.01) && event.t < timestamp_from_seconds(1.09))
      ++counts[event.y * 120U + event.x];
  // 148 events per pixel. The refractory time makes them more uniform than a Poisson process.
  EXPECT_GT(*std::min_element(counts.begin(), counts.end()), 80);
  EXPECT_LT(*std::max_element(counts.begin(), counts.end()), 220);
}

TEST(DisturbedTrajectory, DerivativesAgreeWithDifferences) {
  for (const char* kind : {"gyro-saturation", "shake", "blank-wall", "pure-rotation", "standstill", "put-down"}) {
    SCOPED_TRACE(kind);
    const Simulator simulator(disturbed(kind, 1.0, 1.6));
    for (double t = 0.4013; t < 3.0; t += 0.0737)
      expect_derivatives_at(t, simulator.trajectory(), {.step_s = 1e-5, .a_W = 1e-4});
  }
}

}  // namespace
}  // namespace edged
