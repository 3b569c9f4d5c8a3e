// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/standstill.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kImuRate = 200.0, kPacket_s = 0.05;

/// The measurements of the sensors at time t [s].
struct Readings {
  std::function<Vector3d(double)> gyro = [](double) { return Vector3d(0.01, -0.02, 0.015); };
  std::function<Vector3d(double)> accel = [](double) { return Vector3d(0.05, -0.1, 9.83); };
  double corner_speed = 0.0;  ///< [1/s] on the unit plane
  int features = 40;
  bool events_quiet = false;
  std::optional<KnownMotion> motion = {};
  bool walkers = false;  ///< every other feature goes the other way
  int lifetime = 1000;   ///< packets, after which a feature is another one; staggered
};

class Bench {
 public:
  explicit Bench(const StandstillConfig& config = {}) : detector(config, ImuNoise()) {}

  void run(double duration_s, const Readings& readings) {
    for (int packets = static_cast<int>(std::lround(duration_s / kPacket_s)); packets > 0; --packets) {
      std::vector<ImuSample> imu;
      for (double t = t_; t < t_ + kPacket_s + 1e-9; t += 1.0 / kImuRate) {
        imu.push_back({timestamp_from_seconds(t), readings.gyro(t), readings.accel(t)});
      }
      t_ += kPacket_s;
      place_ += kPacket_s * readings.corner_speed;
      ++packet_;
      CameraObservations seen{"frames", {}};
      for (int i = 0; i < readings.features; ++i) {
        const double way = readings.walkers && i % 2 == 1 ? -place_ : place_;
        const int id = i + 1 + (packet_ + i) / readings.lifetime * 1000;
        seen.features.push_back({static_cast<FeatureId>(id), {0.01 * i + way, 0.02 * (i % 7)}, 0.005});
      }
      detector.add(imu, {seen}, readings.events_quiet, Vector3d::Zero(), [&] { return readings.motion; });
    }
  }

  StandstillDetector detector;

 private:
  double t_ = 1.0, place_ = 0.0;
  int packet_ = 0;
};

TEST(StandstillDetector, SeesRestOnceItsWindowIsFull) {
  Bench bench;
  bench.run(0.3, {});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("0.30 of 0.40 s"));
  bench.run(0.1, {});
  EXPECT_TRUE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), IsEmpty());
  EXPECT_LT((bench.detector.mean_gyro_B() - Vector3d(0.01, -0.02, 0.015)).norm(), 1e-9);
  EXPECT_LT((bench.detector.mean_accel_B() - Vector3d(0.05, -0.1, 9.83)).norm(), 1e-9);
}

TEST(StandstillDetector, SeesRestThroughTheNoiseOfAnImu) {
  std::mt19937_64 random(3);
  const auto noise = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2.0 - 1.0; };
  // Uniform noise of the power of an MPU-6150's white noise at this rate, and three times that of most others.
  Readings readings;
  readings.gyro = [&](double) { return Vector3d(0.02 * noise(), 0.02 * noise(), 0.02 * noise()); };
  readings.accel = [&](double) { return Vector3d(0.25 * noise(), 0.25 * noise(), 9.81 + 0.25 * noise()); };
  Bench bench;
  bench.run(0.4, readings);
  for (int i = 0; i < 100; ++i) {
    bench.run(kPacket_s, readings);
    ASSERT_TRUE(bench.detector.still()) << bench.detector.reason();
  }
}

TEST(StandstillDetector, IsNotFooledBySteadyMotionThatTheImuCannotFeel) {
  // 5 cm/s past a wall at 2 m: 25 mrad/s in the image, nothing in the IMU.
  Bench bench;
  bench.run(1.0, {.corner_speed = 0.025});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("features move 0.01"));
}

TEST(StandstillDetector, ToleratesTheJitterOfCorners) {
  Bench bench;
  bench.run(1.0, {.corner_speed = 0.005});  // 2 mrad over the window, under half a pixel of 200
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
}

TEST(StandstillDetector, SeesTurningBySpreadAndByMean) {
  Bench swaying;
  swaying.run(0.8, {.gyro = [](double t) { return Vector3d(0, 0.1 * std::sin(10.0 * t), 0); }});
  EXPECT_FALSE(swaying.detector.still());
  EXPECT_THAT(swaying.detector.reason(), HasSubstr("turning"));
  Bench steady;
  steady.run(1.0, {.gyro = [](double) { return Vector3d(0, 0, 0.3); }});
  EXPECT_FALSE(steady.detector.still());
  EXPECT_THAT(steady.detector.reason(), HasSubstr("mean 0.300 of 0.150"));
}

TEST(StandstillDetector, TakesASlowPanForNoBias) {
  // 6 deg/s for long: nothing in the IMU tells it from a bias, but the picture moves as much.
  const Readings pan{.gyro = [](double) { return Vector3d(0, 0.105, 0); }, .corner_speed = 0.105};
  Bench bench;
  for (int i = 0; i < 10; ++i) {
    bench.run(0.5, pan);
    EXPECT_FALSE(bench.detector.still());
  }
  EXPECT_THAT(bench.detector.reason(), HasSubstr("turning steadily"));
  Bench biased;
  biased.run(1.0, {.gyro = pan.gyro});
  EXPECT_TRUE(biased.detector.still()) << biased.detector.reason();
}

TEST(StandstillDetector, SeesAPictureThatStandsWhileTheImuShakes) {
  const auto engines = [](double t) { return Vector3d(0.3 * std::sin(30.0 * t), 0, 9.81); };
  Bench bench;
  bench.run(0.6, {.accel = engines});
  EXPECT_FALSE(bench.detector.still() || bench.detector.image_static()) << "who starts to move looks alike";
  bench.run(0.5, {.accel = engines});
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
  EXPECT_THAT(bench.detector.reason(), IsEmpty());
  bench.run(0.5, {.accel = engines, .corner_speed = 0.05});
  EXPECT_FALSE(bench.detector.image_static() || bench.detector.still());
  bench.run(2.0, {.accel = engines, .corner_speed = 0.002});
  EXPECT_FALSE(bench.detector.still()) << "2 mm/s at 1 m is motion";
}

TEST(StandstillDetector, SeesAPush) {
  Bench bench;
  bench.run(1.0, {});
  ASSERT_TRUE(bench.detector.still());
  // From rest to 0.1 m/s within 0.2 s.
  bench.run(0.2, {.accel = [](double) { return Vector3d(0.55, -0.1, 9.83); }});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("accelerating"));
}

TEST(StandstillDetector, TakesTheVibrationOfMotorsForRest) {
  // 80 Hz, 1 m/s^2 and 0.05 rad/s: a tenth of a pixel. The block means must not contain it, whatever its phase.
  for (int phase = 0; phase < 8; ++phase) {
    Bench bench;
    bench.run(1.0, {.gyro = [&](double t) { return Vector3d(0.05 * std::sin(503.0 * t + phase), 0, 0); },
                    .accel = [&](double t) { return Vector3d(0, std::sin(503.0 * t + phase), 9.81); }});
    EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
  }
}

TEST(StandstillDetector, BelievesQuietEventsWhereThereAreNoCorners) {
  Bench quiet, busy;
  quiet.run(1.0, {.features = 0, .events_quiet = true});
  EXPECT_TRUE(quiet.detector.still()) << quiet.detector.reason();
  busy.run(0.6, {.features = 0, .events_quiet = false});
  EXPECT_FALSE(busy.detector.still());
  EXPECT_THAT(busy.detector.reason(), HasSubstr("0 of 8 features"));
  busy.run(0.1, {.features = 0, .events_quiet = false});
  EXPECT_TRUE(busy.detector.still()) << "the IMU alone: " << busy.detector.reason();
}

TEST(StandstillDetector, BelievesMovingCornersMoreThanQuietEvents) {
  Bench bench;
  bench.run(1.0, {.corner_speed = 0.05, .events_quiet = true});
  EXPECT_FALSE(bench.detector.still());
}

/// Half of the features walk to the left, half to the right, as fast as corner_speed would.
TEST(StandstillDetector, BelievesAQuietImuThoughAllThatIsSeenWalks) {
  Bench bench;
  bench.run(0.65, {.corner_speed = 0.05, .walkers = true});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("features move"));
  bench.run(0.1, {.corner_speed = 0.05, .walkers = true});
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
  EXPECT_TRUE(bench.detector.still_by_imu());
}

TEST(StandstillDetector, TakesObjectsThatPassTooFastToBeFollowedForNoMotion) {
  Bench bench;
  bench.run(0.75, {.corner_speed = 0.85, .lifetime = 6});  // 0.3 s each, under the window
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
}

TEST(StandstillDetector, FollowsFeaturesOfCamerasThatTakeTurns) {
  StandstillDetector detector({}, ImuNoise());
  for (int packet = 0; packet < 20; ++packet) {
    const double t = 1.0 + kPacket_s * packet;
    std::vector<ImuSample> imu;
    for (int i = 0; i <= 10; ++i)
      imu.push_back({timestamp_from_seconds(t - kPacket_s + 0.005 * i), Vector3d::Zero(), Vector3d(0, 0, 9.81)});
    const bool events = packet % 2 == 0;
    CameraObservations seen{events ? "events" : "frames", {}};
    for (int i = 0; i < 6; ++i)
      seen.features.push_back({static_cast<FeatureId>(i + (events ? 1 : 100)), {0.1 * i + 0.025 * t, 0.0}, 0.005});
    detector.add(imu, {seen}, false);
  }
  EXPECT_FALSE(detector.still());
  EXPECT_THAT(detector.reason(), HasSubstr("features move 0.0100"));
}

TEST(StandstillDetector, ACalmHandIsNoQuietImu) {
  Bench bench;
  // Tremor: 2 deg/s about, 0.15 m/s^2.
  bench.run(3.0, {.gyro = [](double t) { return Vector3d(0.03 * std::sin(4.0 * t), 0.01, 0); },
                  .accel = [](double t) { return Vector3d(0.15 * std::sin(5.0 * t), 0, 9.81); },
                  .corner_speed = 0.05,
                  .walkers = true});
  EXPECT_FALSE(bench.detector.still());
}

TEST(StandstillDetector, NeedsTheWholeWindowQuiet) {
  // An IMU that is calm, but not quiet enough to suffice alone.
  const auto swaying = [](double t) { return Vector3d(0.008 * std::sin(9.0 * t), 0, 0); };
  Bench bench;
  bench.run(1.0, {.gyro = swaying, .features = 0, .events_quiet = true});
  bench.run(kPacket_s, {.gyro = swaying, .features = 0, .events_quiet = false});
  bench.run(0.3, {.gyro = swaying, .features = 0, .events_quiet = true});
  EXPECT_FALSE(bench.detector.still());
  bench.run(0.15, {.gyro = swaying, .features = 0, .events_quiet = true});
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
}

TEST(StandstillDetector, ForgetsMotionAfterItsWindow) {
  Bench bench;
  bench.run(1.0, {.gyro = [](double t) { return Vector3d(0, std::sin(5.0 * t), 0); }, .corner_speed = 0.5});
  ASSERT_FALSE(bench.detector.still());
  bench.run(0.35, {});
  EXPECT_FALSE(bench.detector.still());
  bench.run(0.1, {});
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
}

/// A quiet IMU, features that move together by 10 mrad over the window: 5 cm/s past a scene at 2 m.
constexpr double kGentle = 0.025;
const auto kNoBias = [](double) { return Vector3d(0.0001, 0, 0); };

TEST(StandstillDetector, TakesGentleMotionThatTheEstimateAllowsForNoRest) {
  const KnownMotion uncertain{.speed = 0.01, .speed_sigma = 0.02, .rate_sigma = 1e-3, .depth_m = 2.0};
  Bench bench;
  bench.run(4.0, {.gyro = kNoBias, .corner_speed = kGentle, .motion = uncertain});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("motion that the IMU does not measure"));
  const KnownMotion moving{.speed = 0.05, .speed_sigma = 0.005, .rate_sigma = 1e-3, .depth_m = 2.0};
  bench.run(4.0, {.gyro = kNoBias, .corner_speed = kGentle, .motion = moving});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("moving at 0.050 of 0.018 m/s"));
}

TEST(StandstillDetector, TakesMotionThatNoEstimateAllowsForThatOfObjects) {
  const KnownMotion certain{.speed = 0.002, .speed_sigma = 0.003, .rate_sigma = 2e-4, .depth_m = 2.0};
  Bench bench;
  bench.run(3.0, {.gyro = kNoBias, .corner_speed = 0.3, .motion = certain});
  EXPECT_TRUE(bench.detector.still()) << bench.detector.reason();
}

TEST(StandstillDetector, StartsInNoGentleMotion) {
  Bench gentle, walked;
  gentle.run(4.0, {.gyro = kNoBias, .corner_speed = 0.08});
  EXPECT_FALSE(gentle.detector.still());
  walked.run(4.0, {.gyro = kNoBias, .corner_speed = 0.4});
  EXPECT_TRUE(walked.detector.still()) << walked.detector.reason();
}

TEST(StandstillDetector, StillImagesDoNotHideASlowTurnThatTheGyroTells) {
  const Readings turning{.gyro = [](double) { return Vector3d(0, 0, 0.006); },
                         .motion = KnownMotion{.speed_sigma = 0.01, .rate_sigma = 5e-4}};
  Bench bench;
  bench.run(1.0, turning);
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("turning at 0.0060 of 0.0018 rad/s"));
  // An estimate that would move the images by far more is wrong.
  const Readings diverged{.gyro = kNoBias,
                          .motion = KnownMotion{.speed = 0.1, .speed_sigma = 0.01, .rate_sigma = 1e-3, .depth_m = 1.0}};
  Bench still;
  still.run(1.0, diverged);
  EXPECT_TRUE(still.detector.still()) << still.detector.reason();
}

TEST(StandstillDetector, SeesSlowMotionThatFeaturesShare) {
  // 2 mrad over the window, under half a pixel of 200; the IMU is calm, but not quiet.
  const auto swaying = [](double t) { return Vector3d(0.009 * std::sin(9.0 * t), 0, 0); };
  Bench bench;
  bench.run(1.0, {.gyro = swaying, .corner_speed = 0.005});
  EXPECT_FALSE(bench.detector.still());
  EXPECT_THAT(bench.detector.reason(), HasSubstr("together 0.0020 of 0.0004"));
}

TEST(StandstillDetector, TakesKnownVibrationForNoMotion) {
  std::mt19937_64 random(3);
  const auto noise = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2.0 - 1.0; };
  Readings readings;
  readings.accel = [&](double) { return Vector3d(noise(), noise(), 9.81 + noise()); };  // 0.041 m/s^2/sqrt(Hz)
  int rests = 0, shaken = 0, measured = 0;
  Bench known, unknown;
  const ImuNoise calibrated;
  known.detector.set_noise({.accel_noise = std::hypot(calibrated.accel_noise, 0.041)});
  EXPECT_NEAR(known.detector.mean_accel_sigma(0.4), 0.041 / std::sqrt(0.4), 1e-6);
  for (int i = 0; i < 60; ++i) {
    known.run(kPacket_s, readings);
    unknown.run(kPacket_s, readings);
    if (i < 10) continue;
    rests += known.detector.still() ? 1 : 0;
    if (i < 20) shaken += unknown.detector.still() ? 0 : 1;
    if (i >= 30) measured += unknown.detector.still() ? 1 : 0;
  }
  EXPECT_EQ(rests, 50) << known.detector.reason();
  EXPECT_GE(shaken, 5) << "it is not known yet";
  EXPECT_EQ(measured, 30) << unknown.detector.reason();
}

/// A slow IMU shows the vibration of motors as a slow oscillation, as wide as motion.
TEST(StandstillDetector, MeasuresTheNoiseOfAnImuThatShakesSlowlyAtRest) {
  const Readings readings{
      .gyro = [](double t) { return Vector3d(0.2 * std::sin(30.0 * t), 0, 0.2 * std::cos(33.0 * t)); },
      .accel = [](double t) { return Vector3d(3.0 * std::sin(30.0 * t), 0, 9.81); }};
  Bench bench;
  bench.run(0.8, readings);
  EXPECT_FALSE(bench.detector.still() || bench.detector.noise_at_rest());
  bench.run(0.4, readings);
  ASSERT_TRUE(bench.detector.still() && bench.detector.noise_at_rest()) << bench.detector.reason();
  EXPECT_GT(bench.detector.noise_at_rest()->gyro_noise, 0.02);  // 0.2 rad/s for tenths of a second
  EXPECT_GT(bench.detector.noise_at_rest()->accel_noise, 0.2);
  EXPECT_GT(bench.detector.mean_duration_s(), 0.85) << "the longer the mean the better";
  bench.run(0.2, {.gyro = readings.gyro, .accel = readings.accel, .corner_speed = 0.05});
  EXPECT_FALSE(bench.detector.still() || bench.detector.noise_at_rest()) << "images that move";
}

/// A body permanently at rest; returns the estimator after duration_s.
Estimator at_rest(TestWorld& world, double duration_s, bool with_corners) {
  Estimator estimator(world.rig(), world.noise(), {});
  for (int i = 1; i * kPacket_s <= duration_s; ++i) {
    EstimatorInput input = world.packet(i * kPacket_s, kPacket_s, i % 4 == 0);
    if (!with_corners) input.observations.front().features.clear();
    estimator.add(input);
  }
  return estimator;
}

TEST(Standstill, KeepsTheEstimateWhereItIs) {
  for (const bool with_corners : {true, false}) {
    SCOPED_TRACE(with_corners ? "features" : "no features, quiet events");
    TestWorld world({.rest_s = 1000.0});
    const Estimator estimator = at_rest(world, 60.0, with_corners);
    ASSERT_TRUE(estimator.initialized());
    const OdomState state = estimator.newest();
    EXPECT_LT(state.T_O_B.translation().norm(), 0.03);  // 0.010 after a minute
    EXPECT_LT(state.v_O.norm(), 0.008);                 // 0.003
    const Vector3d bias_error = state.bias_gyro - TestWorldOptions{}.bias_gyro;
    EXPECT_LT(bias_error.head<2>().norm(), 1e-3);  // 1e-4
    EXPECT_LT(std::abs(bias_error.z()),
              with_corners ? 1e-3 : 0.02);  // without features only the prior constrains yaw
  }
}

}  // namespace
}  // namespace edged
