// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Initialization for all kinds of begin of a recording, against the ground truth of the analytic world.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edged/core/angles.hpp"
#include "edged/estimator/estimator.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

struct Started {
  double after_s = 0.0;      ///< since the beginning
  double scale_error = 0.0;  ///< spread of the window's positions over the true one, minus 1
  double tilt_deg = 0.0;
  double speed_error = 0.0, speed = 0.0;  ///< [m/s], in the body frame
};

double spread(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  double sum = 0.0;
  for (const Eigen::Vector3d& p : points) sum += (p - mean).squaredNorm();
  return std::sqrt(sum);
}

/// A velocity sensor at 20 Hz; R_B_S: its true mounting, which the options do not know. With it a provisional
/// initialization counts.
using Velocities = std::optional<Eigen::Quaterniond>;

/// Runs the estimator from begin_s until it has converged; nothing if it does not within patience_s.
std::optional<Started> start(const TestWorldOptions& options, double begin_s, double patience_s,
                             std::vector<std::string>* waited_for = nullptr, const Velocities& R_B_S = std::nullopt,
                             const std::optional<BiasPrior>& biases = {}) {
  TestWorld world(options), sensor(options);
  Estimator estimator(world.rig(), world.noise(), {}, {}, biases);
  for (int i = 1; i * kPacket_s <= patience_s; ++i) {
    const double t = begin_s + i * kPacket_s;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    if (R_B_S) {
      VelocitySample sample = sensor.velocity(t - kPacket_s / 2, 0.05);
      sample.v_S = R_B_S->conjugate() * sample.v_S;
      input.external.emplace_back(sample);
    }
    const EstimatorResult result = estimator.add(input);
    if (!estimator.initialized() || (estimator.provisional() && !R_B_S)) {
      if (waited_for != nullptr) waited_for->push_back(result.waiting_for);
      continue;
    }
    Started started;
    started.after_s = i * kPacket_s;
    std::vector<Eigen::Vector3d> estimated, truth;
    for (const auto& [id, state] : estimator.window().states()) {
      estimated.push_back(state.T_O_B().translation());
      truth.push_back(world.T_W_B(to_seconds(state.t)).translation());
    }
    started.scale_error = spread(truth) > 1e-6 ? spread(estimated) / spread(truth) - 1.0 : 0.0;
    const OdomState state = estimator.newest();
    const SE3 T_O_B = world.T_W_B(t);
    started.tilt_deg = kDegreesPerRadian * std::acos(std::min(1.0, state.T_O_B.R().row(2).dot(T_O_B.R().row(2))));
    started.speed = world.v_W(t).norm();
    started.speed_error =
        (state.T_O_B.rotation().conjugate() * state.v_O - T_O_B.rotation().conjugate() * world.v_W(t)).norm();
    return started;
  }
  return std::nullopt;
}

struct StartCase {
  std::string name;
  TestWorldOptions options;
  double patience_s;
  bool large_biases = false;  ///< 0.1 rad/s and 0.5 m/s^2 in some direction
};
void PrintTo(const StartCase& start, std::ostream* out) { *out << start.name; }

class Beginning : public testing::TestWithParam<StartCase> {};

TEST_P(Beginning, IsRightAtEverySeed) {
  const StartCase& how = GetParam();
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TestWorldOptions options = how.options;
    options.seed = seed;
    const double phase = 0.7 * static_cast<double>(seed);
    if (how.large_biases) {
      options.bias_gyro = 0.1 * Eigen::Vector3d(std::cos(phase), std::sin(phase), 0.5).normalized();
      options.bias_accel = 0.5 * Eigen::Vector3d(0.3, std::cos(2.0 * phase), std::sin(2.0 * phase)).normalized();
    }
    std::vector<std::string> waited_for;
    const auto started = start(options, options.rest_s > 0.0 ? 0.0 : 1.0 + phase, how.patience_s, &waited_for);
    ASSERT_TRUE(started.has_value()) << waited_for.back();
    std::printf("%s %d: after %.2f s, scale %+.3f, tilt %.2f deg, speed %.3f of %.3f m/s off\n", how.name.c_str(),
                static_cast<int>(seed), started->after_s, started->scale_error, started->tilt_deg, started->speed_error,
                started->speed);
    EXPECT_LT(std::abs(started->scale_error), 0.25);
    EXPECT_LT(started->tilt_deg, 3.5);  // an accelerometer bias of 0.5 m/s^2 is 2.9 deg
    EXPECT_LT(started->speed_error, 0.25 * started->speed + 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Initializer, Beginning,
    testing::Values(StartCase{"rest", {.rest_s = 1.0}, 1.0}, StartCase{"rest_large_biases", {.rest_s = 1.0}, 1.0, true},
                    StartCase{"smooth", {}, 3.0}, StartCase{"smooth_drifting_tracks", {.pixel_walk = 0.7}, 3.0},
                    StartCase{"small", {.speed = 0.3}, 6.0}, StartCase{"slow", {.tempo = 0.4}, 25.0},
                    StartCase{"aggressive", {.tempo = 2.5}, 1.5}, StartCase{"large_biases", {}, 3.0, true},
                    StartCase{"near", {.speed = 0.1, .tempo = 2.0, .near_m = 0.2, .far_m = 0.5}, 3.0},
                    StartCase{"far", {.near_m = 12.0, .far_m = 20.0}, 6.0},
                    StartCase{"far_and_fast", {.speed = 4.0, .near_m = 12.0, .far_m = 20.0}, 3.0},
                    StartCase{"without_turning", {.turn = 0.0}, 4.0}, StartCase{"two_cameras", {.cameras = 2}, 3.0}),
    [](const auto& test) { return test.param.name; });

TEST(Initializer, ReliesOnTheBiasesOfAnEarlierEstimate) {
  double known_sum = 0.0, found_sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TestWorldOptions options{.speed = 0.5, .pixel_noise = 0.5, .seed = seed};
    options.bias_gyro = {0.05, -0.06, 0.04}, options.bias_accel = {0.3, -0.2, 0.25};
    const BiasPrior biases{options.bias_gyro, options.bias_accel, 0.003, 0.03};
    const double begin_s = 1.0 + 0.7 * static_cast<double>(seed);
    const auto found = start(options, begin_s, 6.0), known = start(options, begin_s, 6.0, nullptr, {}, biases);
    ASSERT_TRUE(found && known) << seed;
    EXPECT_LT(known->tilt_deg, 0.7) << seed;
    EXPECT_LE(known->after_s, found->after_s + 0.2) << seed;
    known_sum += std::abs(known->scale_error), found_sum += std::abs(found->scale_error);
  }
  EXPECT_LT(known_sum, 0.8 * found_sum);
}

/// Two cameras that share features need no motion; with noise of half a pixel they need more views.
TEST(Initializer, WithAPairStartsWhateverTheMotion) {
  const std::pair<const char*, TestWorldOptions> kinds[] = {{"rest", {.rest_s = 5.0}},
                                                            {"slow", {.tempo = 0.15}},
                                                            {"rotation", {.speed = 0.0}},
                                                            {"usual", {}},
                                                            {"fast", {.tempo = 2.5}}};
  for (const auto& [noise_px, within_s] : {std::pair{0.15, 0.41}, {0.5, 1.51}}) {
    for (auto [name, options] : kinds) {
      options.cameras = 2, options.shared_ids = true, options.pixel_noise = noise_px;
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        options.seed = seed;
        std::vector<std::string> waited_for;
        const double begin_s = options.rest_s > 0.0 ? 0.0 : 1.0 + 0.7 * static_cast<double>(seed);
        const auto started = start(options, begin_s, 2.0, &waited_for);
        ASSERT_TRUE(started) << name << ' ' << seed << ": " << waited_for.back();
        std::printf("%.2f px, %s %d: after %.2f s, tilt %.2f deg, speed %.3f of %.3f m/s off\n", noise_px, name,
                    static_cast<int>(seed), started->after_s, started->tilt_deg, started->speed_error, started->speed);
        EXPECT_LT(started->after_s, within_s) << name;
        EXPECT_LT(started->tilt_deg, 3.0) << name;
        EXPECT_LT(started->speed_error, 0.03 * started->speed + 0.06) << name;
      }
    }
  }
}

TEST(Initializer, RefusesPureRotationWithNumbers) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const double pixel_walk : {0.0, 0.7}) {
      std::vector<std::string> waited_for;
      EXPECT_FALSE(start({.speed = 0.0, .pixel_walk = pixel_walk, .seed = seed}, 1.0, 8.0, &waited_for));
      EXPECT_THAT(waited_for.back(), testing::ContainsRegex("or (motion that|[0-9]+ of 15 landmarks in motion)"));
    }
  }
}

TEST(Initializer, StartsOnceTranslationComesAfterRotation) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto started = start({.turn_only_s = 4.0, .seed = seed}, 0.0, 8.0);
    ASSERT_TRUE(started.has_value());
    EXPECT_GT(started->after_s, 4.0);
    EXPECT_LT(started->after_s, 6.0);
    EXPECT_LT(std::abs(started->scale_error), 0.15);
  }
}

TEST(Initializer, WaitsForMotionThatTellsTheScale) {
  // Much parallax, but next to no acceleration: the accelerometer bias would explain any scale.
  std::vector<std::string> waited_for;
  EXPECT_FALSE(start({.tempo = 0.15}, 2.0, 4.0, &waited_for));
  EXPECT_THAT(waited_for.back(), testing::HasSubstr("motion that determines the scale: known to"));
  EXPECT_THAT(waited_for.back(), testing::HasSubstr("% required"));
}

TEST(Initializer, AVelocityTellsTheScaleOfAMotionWithoutAcceleration) {
  std::vector<std::string> waited_for;
  const auto started = start({.tempo = 0.15}, 2.0, 4.0, &waited_for, Eigen::Quaterniond::Identity());
  ASSERT_TRUE(started) << waited_for.back();
  std::printf("after %.2f s, scale %+.3f, tilt %.2f deg, speed %.3f of %.3f m/s off\n", started->after_s,
              started->scale_error, started->tilt_deg, started->speed_error, started->speed);
  EXPECT_LT(started->after_s, 1.5);
  EXPECT_LT(std::abs(started->scale_error), 0.15);
  EXPECT_LT(started->speed_error, 0.15 * started->speed + 0.02);
}

TEST(Initializer, AVelocityOfWrongAxesDoesNotSpoilAStart) {
  const Eigen::Quaterniond turned = so3::exp({0.0, 0.0, std::numbers::pi / 2.0});
  const auto started = start({}, 1.7, 3.0, nullptr, turned);
  ASSERT_TRUE(started);
  EXPECT_LT(std::abs(started->scale_error), 0.25);
  EXPECT_LT(started->speed_error, 0.25 * started->speed + 0.05);
}

TEST(Initializer, RefusesAnAccelerometerInOtherUnits) {
  TestWorld world({.rest_s = 2.0, .pixel_noise = 0.1});
  Estimator estimator(world.rig(), world.noise(), {});
  EstimatorResult result;
  for (int i = 1; i <= 20; ++i) {
    EstimatorInput input = world.packet(i * kPacket_s, kPacket_s, true);
    std::vector<ImuSample> in_g = input.motion.samples();
    for (ImuSample& sample : in_g) sample.accel_B /= 9.81;
    input.motion = Preintegration(in_g, {0, 0, 0}, {0, 0, 0}, world.noise());
    result = estimator.add(input);
  }
  EXPECT_FALSE(estimator.initialized());
  EXPECT_THAT(result.waiting_for, testing::HasSubstr("it measures 1.0"));
}

}  // namespace
}  // namespace edged
