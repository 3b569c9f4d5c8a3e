// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/alignment.hpp"

#include <gtest/gtest.h>

#include "edged/core/angles.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

constexpr double kSpacing_s = 0.08;
const StartPriors kPriors{.biases = {.gyro_sigma = 0.02, .accel_sigma = 0.15}};

/// `views` views of the world from begin_s on.
std::vector<InitFrame> views_of(TestWorld& world, double begin_s, int views = 20) {
  std::vector<InitFrame> frames;
  for (int i = 0; i < views; ++i) {
    const EstimatorInput input = world.packet(begin_s + i * kSpacing_s, kSpacing_s, true);
    frames.push_back({input.t, input.motion.samples(), input.observations});
  }
  return frames;
}

struct AlignmentErrors {
  double gravity_deg = 0.0;  ///< direction of gravity in the body
  double speed = 0.0;        ///< [m/s], worst view, in the body frame
  double scale = 0.0;        ///< estimated over true distance from first to last view, less one
  double bias_gyro = 0.0;    ///< [rad/s]
};

AlignmentErrors errors_of(const Alignment& alignment, const TestWorld& world, const Eigen::Vector3d& bias_gyro) {
  AlignmentErrors e;
  for (const OdomState& state : alignment.states) {
    const double t = to_seconds(state.t);
    const SE3 truth = world.T_W_B(t);
    const double cosine = state.T_O_B.R().row(2).dot(truth.R().row(2));
    e.gravity_deg = std::max(e.gravity_deg, std::acos(std::min(1.0, cosine)) / kDegree);
    e.speed = std::max(
        e.speed, (state.T_O_B.rotation().conjugate() * state.v_O - truth.rotation().conjugate() * world.v_W(t)).norm());
    e.bias_gyro = std::max(e.bias_gyro, (state.bias_gyro - bias_gyro).norm());
  }
  const auto distance = [](const SE3& a, const SE3& b) { return (a.translation() - b.translation()).norm(); };
  const OdomState &first = alignment.states.front(), &last = alignment.states.back();
  e.scale =
      distance(first.T_O_B, last.T_O_B) / distance(world.T_W_B(to_seconds(first.t)), world.T_W_B(to_seconds(last.t))) -
      1.0;
  return e;
}

/// Worst error over some starts [rad/s].
double worst_gyro_bias_error(double speed) {
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const TestWorldOptions options{.speed = speed, .bias_gyro = {0.05, -0.08, 0.03}, .seed = seed};
    TestWorld world(options);
    const auto bias = align_gyro_bias(views_of(world, 0.3 * static_cast<double>(seed)), world.rig(), world.noise());
    worst = std::max(worst, bias ? (*bias - options.bias_gyro).norm() : 1.0);
  }
  return worst;
}

// Of a bias of 0.1 rad/s, through features half a pixel off.
TEST(AlignGyroBias, FindsTheBiasInMotion) { EXPECT_LT(worst_gyro_bias_error(1.0), 4e-3); }        // 2.0e-3
TEST(AlignGyroBias, FindsTheBiasInPureRotation) { EXPECT_LT(worst_gyro_bias_error(0.0), 5e-3); }  // 2.5e-3
// With a parallax as small as the noise of the features, rotation and translation are hard to separate.
TEST(AlignGyroBias, FindsMostOfTheBiasInSlowMotion) { EXPECT_LT(worst_gyro_bias_error(0.05), 0.02); }  // 0.011

TEST(AlignGyroBias, SaysNothingWithoutCommonCorners) {
  TestWorld world({});
  std::vector<InitFrame> frames = views_of(world, 1.0, 8);
  FeatureId id = 1;
  for (InitFrame& frame : frames) {
    for (FeatureObservation& f : frame.observations.front().features) f.id = id++;
  }
  EXPECT_FALSE(align_gyro_bias(frames, world.rig(), world.noise()).has_value());
  EXPECT_FALSE(align(frames, world.rig(), world.noise(), kPriors).has_value());
}

TEST(Align, IsExactWithoutNoise) {
  const TestWorldOptions options{.pixel_noise = 0.0, .imu_noise = 0.0, .bias_accel = {0, 0, 0}};
  for (const double begin : {0.5, 1.7, 4.0}) {
    TestWorld world(options);
    const auto alignment = align(views_of(world, begin), world.rig(), world.noise(), kPriors);
    ASSERT_TRUE(alignment.has_value());
    const AlignmentErrors e = errors_of(*alignment, world, options.bias_gyro);
    EXPECT_LT(e.gravity_deg, 0.05);
    EXPECT_LT(e.speed, 0.005);
    EXPECT_LT(std::abs(e.scale), 0.005);
    EXPECT_LT(e.bias_gyro, 1e-4);
    EXPECT_LT(std::abs(alignment->gravity_error), 0.005);
  }
}

TEST(Align, FindsGravityVelocityAndScaleThroughNoise) {
  for (const int cameras : {1, 2}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(testing::Message() << cameras << " cameras, seed " << seed);
      const TestWorldOptions options{.cameras = cameras, .bias_accel = {0, 0, 0}, .seed = seed};
      TestWorld world(options);
      const auto alignment =
          align(views_of(world, 0.7 * static_cast<double>(seed)), world.rig(), world.noise(), kPriors);
      ASSERT_TRUE(alignment.has_value());
      const AlignmentErrors e = errors_of(*alignment, world, options.bias_gyro);
      EXPECT_LT(e.gravity_deg, 1.0);                        // worst of these 0.29
      EXPECT_LT(e.speed, 0.1);                              // 0.045
      EXPECT_LT(std::abs(e.scale), 0.1);                    // 0.047
      EXPECT_LT(e.bias_gyro, 6e-3);                         // 3.0e-3
      EXPECT_LT(std::abs(alignment->gravity_error), 0.05);  // 0.016
    }
  }
}

TEST(Align, TurnsAnAccelerometerBiasIntoNoMoreTiltThanItsShareOfGravity) {
  const TestWorldOptions options{.bias_accel = {0.1, -0.1, 0.0}};
  TestWorld world(options);
  const auto alignment = align(views_of(world, 1.0), world.rig(), world.noise(), kPriors);
  ASSERT_TRUE(alignment.has_value());
  const AlignmentErrors e = errors_of(*alignment, world, options.bias_gyro);
  EXPECT_LT(e.gravity_deg, 2.5);
}

TestWorldOptions with_walker(std::uint64_t seed, double begin_s) {
  return {.bias_accel = {0, 0, 0}, .walker = 65, .walker_comes_s = begin_s, .seed = seed};
}

// Relative to the dynamic object the scene moves: least squares over all features are 1 m/s off.
TEST(Align, FollowsTheRoomThoughMostCornersWalk) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const double begin = 0.7 * static_cast<double>(seed);
    const TestWorldOptions options = with_walker(seed, begin);
    TestWorld world(options);
    const auto alignment = align(views_of(world, begin), world.rig(), world.noise(), kPriors);
    ASSERT_TRUE(alignment.has_value());
    const AlignmentErrors e = errors_of(*alignment, world, options.bias_gyro);
    EXPECT_LT(e.speed, 0.15);
    EXPECT_LT(std::abs(e.scale), 0.15);
    const auto walks = [](FeatureId id) { return id >= TestWorld::kWalkerId; };
    const auto walking = std::count_if(alignment->outliers.begin(), alignment->outliers.end(), walks);
    EXPECT_LT(static_cast<std::ptrdiff_t>(alignment->outliers.size()) - walking, 10);
  }
}

TEST(Align, CallsNothingAnOutlierInAWorldThatHoldsStill) {
  TestWorld world({});
  const auto alignment = align(views_of(world, 1.0), world.rig(), world.noise(), kPriors);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_TRUE(alignment->outliers.empty());
}

TEST(Align, TellsAnEstimateOfTheRoomFromOneOfWhatWalksInIt) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const double begin = 0.7 * static_cast<double>(seed);
    TestWorld world(with_walker(seed, begin));
    const std::vector<InitFrame> frames = views_of(world, begin);
    const double t = to_seconds(frames.back().t);
    OdomState state;
    state.t = frames.back().t;
    state.T_O_B = world.T_W_B(t);
    state.v_O = world.v_W(t);
    const auto inlier_share = [&](const OdomState& s) {
      return align(frames, world.rig(), world.noise(), kPriors, &s)->inlier_share;
    };
    const double of_the_room = inlier_share(state);
    EXPECT_GT(of_the_room, 0.6);
    state.v_O -= Eigen::Vector3d(0.6, 0.1, 0.0);
    EXPECT_LT(inlier_share(state), 0.5 * of_the_room);
  }
}

}  // namespace
}  // namespace edged
