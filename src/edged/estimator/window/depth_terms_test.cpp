// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Eq. 5 in the estimator: what a depth source adds where the motion does not determine the scale, and what it must not
// change.
#include "edged/estimator/window/depth_terms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "edged/estimator/solver/marginalization.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

/// A source whose depths of the whole view are the true median times `bias`. Uses a copy of the world, whose noise is
/// the same as without this call.
RegionDepth depth_of_view(TestWorld world, double t, double bias, double sigma_ln) {
  const RigCamera& camera = world.rig().cameras.front();
  const SE3 T_C_O = (world.T_W_B(t) * camera.T_B_C).inverse();
  std::vector<double> depths;
  for (const FeatureObservation& seen : world.observe(t).features) {
    depths.push_back((T_C_O * world.point_W(seen.id)).z());
  }
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
  return {camera.name, {-1, -1}, {1, 1}, bias * depths[depths.size() / 2], sigma_ln, 0.2};
}

struct Outcome {
  double scale_error = 0.0;     ///< |path estimated / path - 1| from `from_s` on
  double position_error = 0.0;  ///< largest, of the motion since the start [m]
  std::optional<LogScale> s;
  std::optional<double> good_s;  ///< when the start was no longer provisional
};

/// bias 0: no source.
Outcome fly(const TestWorldOptions& options, double duration_s, double bias, const EstimatorConfig& config,
            double sigma_ln = 0.6) {
  TestWorld world(options);
  Estimator estimator(world.rig(), world.noise(), config);
  double travelled = 0.0, estimated = 0.0;
  Outcome outcome;
  std::optional<std::pair<SE3, SE3>> first, before;  // truth and estimate
  for (int i = 1; i * kPacket_s <= duration_s; ++i) {
    const double t = i * kPacket_s;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    if (bias > 0.0) input.depth = depth_of_view(world, t, bias, sigma_ln);
    const EstimatorResult result = estimator.add(input);
    if (!estimator.initialized() || estimator.provisional()) continue;
    if (!outcome.good_s) outcome.good_s = t;
    if (result.new_frame) first.reset(), before.reset();
    const std::pair<SE3, SE3> now(world.T_W_B(t), estimator.newest().T_O_B);
    if (!first) first = now;
    if (before) {
      travelled += (now.first.translation() - before->first.translation()).norm();
      estimated += (now.second.translation() - before->second.translation()).norm();
    }
    before = now;
    const SE3 true_motion = first->first.inverse() * now.first, motion = first->second.inverse() * now.second;
    outcome.position_error =
        std::max(outcome.position_error, (true_motion.translation() - motion.translation()).norm());
  }
  EXPECT_TRUE(estimator.initialized() && !estimator.provisional());
  outcome.scale_error = std::abs(estimated / travelled - 1.0);
  outcome.s = estimator.depth_scale();
  return outcome;
}

EstimatorConfig with_depth(DepthResidual form = DepthResidual::Log) {
  EstimatorConfig config;
  config.depth_factor.enabled = true;
  config.depth_factor.form = form;
  return config;
}

TEST(DepthTerms, TheScaleOfABiasedSourceIsFound) {
  for (const DepthResidual form : {DepthResidual::Log, DepthResidual::Paper}) {
    for (const double bias : {0.6, 1.7}) {
      const Outcome outcome = fly({.rest_s = 1.0}, 10.0, bias, with_depth(form));
      ASSERT_TRUE(outcome.s);
      EXPECT_NEAR(outcome.s->value, std::log(bias), 0.12) << "bias " << bias;
      EXPECT_LT(outcome.s->sigma, 0.2);
      EXPECT_LT(std::abs(outcome.s->value - std::log(bias)), 3.0 * outcome.s->sigma);
    }
  }
}

TEST(DepthTerms, NothingIsSaidOfTheScaleWithoutTheFactor) {
  EXPECT_FALSE(fly({.rest_s = 1.0}, 2.0, 1.0, EstimatorConfig()).s);
}

TEST(DepthTerms, ASourceThatIsFarOffLeavesAWellConditionedRunAlone) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const TestWorldOptions world{.rest_s = 1.0, .seed = seed};
    const Outcome without = fly(world, 8.0, 0.0, EstimatorConfig());
    for (const double bias : {0.5, 0.7, 1.3, 1.5}) {
      const Outcome with = fly(world, 8.0, bias, with_depth());
      EXPECT_LT(with.position_error, 1.1 * without.position_error + 0.002) << "seed " << seed << " bias " << bias;
      EXPECT_LT(with.scale_error, without.scale_error + 0.003) << "seed " << seed << " bias " << bias;
    }
  }
}

// Initialized in slow motion: the accelerometer bias hides the scale for seconds. The camera rotations are fixed, as an
// error of them hides it too. Initialization waits until the scale is known, so a depth source gains time, not
// accuracy.
TEST(DepthTerms, AGoodSourceTellsTheScaleOfSlowMotionSooner) {
  constexpr double kPatience_s = 12.0;
  EstimatorConfig alone, config = with_depth();
  alone.calibration = config.calibration = {.rotation_sigma_deg = 0.0, .time_offset_sigma_ms = 0.0};
  config.depth_factor.scale_sigma = 0.05;
  alone.track_noise = config.track_noise = {0.0, 0.0};  // as in this world
  double without_s = 0.0, with_s = 0.0, with_error = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const TestWorldOptions slow{.speed = 0.08, .bias_accel = {0.1, -0.15, 0.1}, .seed = seed};
    without_s += fly(slow, kPatience_s, 0.0, alone).good_s.value_or(kPatience_s) / 4.0;
    const Outcome with = fly(slow, kPatience_s, 1.0, config, 0.08);
    with_s += with.good_s.value_or(kPatience_s) / 4.0;
    with_error += with.scale_error / 4.0;
  }
  EXPECT_LT(with_s, 0.9 * without_s) << "good after " << with_s << " s, without the factor " << without_s;
  EXPECT_LT(with_error, 0.25);  // of the length of a path whose speed is that of its jitter
}

TEST(DepthTerms, AStartInMotionFarFromWhatTheSourceSaysIsNotBelieved) {
  TestWorld world({});
  Estimator estimator(world.rig(), world.noise(), with_depth());
  for (int i = 1; i <= 40; ++i) {
    const double t = i * kPacket_s;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    input.depth = depth_of_view(world, t, 30.0, 0.6);
    estimator.add(input);
  }
  EXPECT_FALSE(estimator.initialized());
}

TEST(DepthTerms, RepeatToTheBit) {
  const Outcome a = fly({.rest_s = 0.5}, 4.0, 1.2, with_depth()), b = fly({.rest_s = 0.5}, 4.0, 1.2, with_depth());
  EXPECT_EQ(a.position_error, b.position_error);
  EXPECT_EQ(a.s->value, b.s->value);
  EXPECT_EQ(a.s->sigma, b.s->sigma);
}

}  // namespace
}  // namespace edged
