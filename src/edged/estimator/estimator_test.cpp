// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/estimator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edged/core/angles.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

struct RunResult {
  bool initialized = false;
  double started_at = 0.0;
  double max_position_error = 0.0, max_tilt_error = 0.0, travelled_ratio = 0.0;
  Eigen::Vector3d bias_gyro, bias_accel;
  std::string waiting_for;
  RigCamera camera;  ///< as calibrated
};

/// Runs the estimator through the world; errors are of the motion since the start, in the frame of the start.
RunResult run(const TestWorldOptions& options, double duration, const EstimatorConfig& config = {}) {
  TestWorld world(options);
  Estimator estimator(world.rig(), world.noise(), config);
  RunResult result;
  SE3 T_true_est;
  double travelled = 0.0, estimated = 0.0;
  Eigen::Vector3d last_true = Eigen::Vector3d::Zero(), last_estimated = Eigen::Vector3d::Zero();
  for (int i = 1; i * kPacket_s <= duration; ++i) {
    const double t = i * kPacket_s;
    const EstimatorResult output = estimator.add(world.packet(t, kPacket_s, i % 4 == 0));
    result.waiting_for = output.waiting_for;
    if (!estimator.initialized()) continue;
    const OdomState state = estimator.newest();
    const SE3 truth = world.T_W_B(t);
    if (!result.initialized) {
      result.initialized = true;
      result.started_at = t;
      T_true_est = alignment_at(truth, state.T_O_B);  // yaw and position are not observable
    } else {
      travelled += (truth.translation() - last_true).norm();
      estimated += (state.T_O_B.translation() - last_estimated).norm();
    }
    last_true = truth.translation();
    last_estimated = state.T_O_B.translation();
    const SE3 aligned = T_true_est * state.T_O_B;
    result.max_position_error =
        std::max(result.max_position_error, (aligned.translation() - truth.translation()).norm());
    result.max_tilt_error = std::max(result.max_tilt_error, (aligned.R().row(2) - truth.R().row(2)).norm());
    result.bias_gyro = state.bias_gyro;
    result.bias_accel = state.bias_accel;
  }
  result.camera = estimator.window().cameras()[0].calibrated();
  result.travelled_ratio = travelled > 0 ? estimated / travelled : 0.0;
  return result;
}

/// Mean sigma of the observations of the newest state, on the unit plane.
double mean_sigma(const Window& window) {
  double sum = 0.0;
  int n = 0;
  for (const auto& [id, feature] : window.features()) {
    const auto seen = feature.observations.find({window.newest_id(), 0});
    if (seen == feature.observations.end()) continue;
    sum += seen->second.sigma;
    ++n;
  }
  return n == 0 ? 0.0 : sum / n;
}

TEST(Estimator, BelievesCornersLessWhileTheGyroIsBeyondItsRange) {
  TestWorld world({.rest_s = 1.0});
  Estimator estimator(world.rig(), world.noise(), {});
  int i = 1;
  for (; i * kPacket_s < 2.0; ++i) estimator.add(world.packet(i * kPacket_s, kPacket_s, i % 4 == 0));
  const double usual = mean_sigma(estimator.window());
  ASSERT_GT(usual, 0.0);
  EstimatorInput clipped = world.packet(i * kPacket_s, kPacket_s, false);
  std::vector<ImuSample> samples = clipped.motion.samples();
  samples[samples.size() / 2].gyro_B.x() = world.noise().gyro_saturation;
  clipped.motion = Preintegration(samples, clipped.motion.bias_gyro(), clipped.motion.bias_accel(), world.noise());
  estimator.add(clipped);
  EXPECT_NEAR(mean_sigma(estimator.window()) / usual, 6.0, 1.0);
}

TEST(Estimator, StartsAtRestAndFollowsTheMotion) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const TestWorldOptions options{.rest_s = 1.0, .seed = seed};
    const RunResult result = run(options, 15.0);
    ASSERT_TRUE(result.initialized);
    EXPECT_LT(result.started_at, 1.0);
    EXPECT_LT(result.max_position_error, 0.05);
    EXPECT_LT(result.max_tilt_error, 0.02);
    EXPECT_NEAR(result.travelled_ratio, 1.0, 0.02);
    EXPECT_LT((result.bias_gyro - options.bias_gyro).norm(), 1e-3);
    EXPECT_LT((result.bias_accel - options.bias_accel).norm(), 0.03);
  }
}

TEST(Estimator, LearnsTheGyrosBiasFromAMomentOfRest) {
  const TestWorldOptions options{.rest_s = 2.0};
  TestWorld world(options);
  Estimator estimator(world.rig(), world.noise(), EstimatorConfig());
  for (int i = 1; i <= 24; ++i) estimator.add(world.packet(0.05 * i, 0.05, i % 4 == 0));
  ASSERT_TRUE(estimator.initialized());
  EXPECT_LT((estimator.newest().bias_gyro - options.bias_gyro).norm(), 1e-3);
  const Eigen::Matrix3d P = estimator.covariance().value().block<3, 3>(9, 9);
  EXPECT_LT(P.diagonal().maxCoeff(), 1e-3 * 1e-3);
}

TEST(Estimator, StartsInMotionAndFindsScaleAndGravity) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const TestWorldOptions options{.seed = seed};
    const RunResult result = run(options, 15.0);
    ASSERT_TRUE(result.initialized) << result.waiting_for;
    EXPECT_LT(result.started_at, 2.0);
    EXPECT_LT(result.max_tilt_error, 0.06);
    // The accelerometer bias becomes observable only with time: until then the scale is a few percent off.
    EXPECT_NEAR(result.travelled_ratio, 1.0, 0.05);
    EXPECT_LT((result.bias_accel - options.bias_accel).norm(), 0.04);
  }
}

TEST(Estimator, LeavesOfAKeyframeWhatTheWindowLearntOfIt) {
  TestWorld world({.rest_s = 1.0, .cameras = 2});
  Estimator estimator(world.rig(), world.noise(), {});
  std::size_t keyframes = 0, seen = 0, left = 0;
  double depth_error = 0.0, depth_sigma = 0.0;
  for (int i = 1; i * kPacket_s <= 8.0; ++i) {
    for (const MarginalizedKeyframe& record :
         estimator.add(world.packet(i * kPacket_s, kPacket_s, i % 4 == 0)).marginalized_keyframes) {
      const double t = to_seconds(record.t);
      if (t < 3.0) continue;  // at rest no depth is known
      ++keyframes;
      ASSERT_EQ(record.views.size(), 2U);
      for (std::size_t camera = 0; camera < 2; ++camera) {
        const KeyframeView& view = record.views[camera];
        EXPECT_EQ(view.camera, world.rig().cameras[camera].name);
        seen += world.observe(t, camera).features.size();
        left += view.points.size();
        const SE3 T_C_O = (world.T_W_B(t) * view.T_B_C).inverse();
        for (const KeyframePoint& point : view.points) {
          const Eigen::Vector3d p_C = T_C_O * world.point_W(point.id);
          EXPECT_LT((point.point - p_C.hnormalized()).norm(), 0.03);
          depth_error += std::abs(point.inverse_depth * p_C.z() - 1.0);
          depth_sigma += point.sigma / point.inverse_depth;
        }
      }
    }
  }
  EXPECT_GT(keyframes, 12U);
  EXPECT_GT(left, seen / 2) << "landmarks are fewer than features";
  EXPECT_LT(depth_error, 0.03 * static_cast<double>(left));
  EXPECT_GT(depth_sigma, 0.5 * depth_error) << "as certain as its covariance";
}

TEST(Estimator, WaitsDuringPureRotationAndSaysForWhat) {
  const RunResult result = run({.speed = 0.0}, 5.0);
  EXPECT_FALSE(result.initialized);
  EXPECT_THAT(result.waiting_for, testing::HasSubstr("motion that determines the scale"));
}

EstimatorConfig self_calibrating() {
  EstimatorConfig config;
  config.calibration = CalibrationConfig::fixed();
  config.calibration.rotation_sigma_deg = 1.0;
  config.calibration.time_offset_sigma_ms = 5.0;
  config.calibration.imu_sigma = 5e-3;
  return config;
}

TEST(Estimator, FindsWhatTheCamerasRotationAndClockAreOffBy) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const double sign : {1.0, -1.0}) {
      TestWorldOptions options{.rest_s = seed == 1 ? 1.0 : 0.0, .turn = 1.5, .tempo = 2.0, .seed = seed};
      options.rotation_error = sign * 2.0 * kDegree * Eigen::Vector3d(0.5, -0.7, 0.51).normalized();
      options.time_error = sign * 0.010;
      const RunResult result = run(options, 15.0, self_calibrating());
      ASSERT_TRUE(result.initialized) << result.waiting_for;
      const RigCamera given = TestWorld(options).rig().cameras[0], found = result.camera;
      const Eigen::Vector3d turned = so3::log((given.T_B_C.inverse() * found.T_B_C).rotation());
      EXPECT_LT((turned - options.rotation_error).norm(), 0.2 * kDegree) << seed << " " << sign;
      EXPECT_NEAR(to_seconds(found.time_offset), options.time_error, 5e-4) << seed << " " << sign;
      EXPECT_NEAR(result.travelled_ratio, 1.0, 0.05);
    }
  }
}

TEST(Estimator, FindsWhatScaleAndAxesOfTheGyroAreOffBy) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    TestWorldOptions options{.rest_s = 1.0, .turn = 1.5, .tempo = 2.0, .seed = seed};
    // Symmetric part only: the rest is a rotation of the gyro, which cannot be separated from one of the camera.
    options.gyro_error << 6e-3, 2e-3, -3e-3, 2e-3, -5e-3, 1e-3, -3e-3, 1e-3, 4e-3;
    TestWorld world(options);
    Estimator estimator(world.rig(), world.noise(), EstimatorConfig());
    for (int i = 1; i <= 300; ++i) estimator.add(world.packet(0.05 * i, 0.05, i % 4 == 0));
    const double* block = estimator.window().block(kImuIntrinsicsKey);
    const Eigen::Matrix3d found = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block);
    const Eigen::Matrix3d off = 0.5 * (found + found.transpose()) - options.gyro_error;
    EXPECT_LT(off.norm(), 0.5 * options.gyro_error.norm()) << off;
  }
}

TEST(Estimator, LeavesAnExactCalibrationWhereItIs) {
  const TestWorldOptions options{.rest_s = 1.0, .turn = 1.5, .tempo = 2.0};
  const RigCamera given = TestWorld(options).rig().cameras[0], found = run(options, 15.0, self_calibrating()).camera;
  EXPECT_LT(so3::log((given.T_B_C.inverse() * found.T_B_C).rotation()).norm(), 2e-3);
  EXPECT_LT(std::abs(to_seconds(found.time_offset)), 5e-4);
}

/// A world whose lens has distortion, with wrong lever arm and intrinsics.
TestWorldOptions miscalibrated(std::uint64_t seed) {
  TestWorldOptions options{.rest_s = 1.0, .turn = 2.0, .tempo = 2.0, .pixel_noise = 0.1, .seed = seed};
  options.distortion = {-0.37, 0.15, -3e-4, -7e-4, 0.0};
  const double sign = seed % 2 == 0 ? -1.0 : 1.0;
  options.intrinsics_error << 0.008 * sign, 0.006, 0.006 * sign, -0.008, -0.015 * sign, 0.012 * sign;
  options.lever_arm_error = sign * Eigen::Vector3d(0.008, -0.006, 0.007);
  return options;
}

struct CalibrationAfter {
  CalibrationVector found, sigmas;
};

CalibrationAfter calibration_after(const TestWorldOptions& options, double duration_s) {
  TestWorld world(options);
  Estimator estimator(world.rig(), world.noise(), EstimatorConfig());
  for (int i = 1; i <= std::lround(duration_s / 0.05); ++i) estimator.add(world.packet(0.05 * i, 0.05, i % 4 == 0));
  EXPECT_TRUE(estimator.initialized());
  return {CalibrationVector(estimator.window().block({BlockKind::Calibration, 0})),
          estimator.calibration_covariance(0)->diagonal().cwiseSqrt()};
}

TEST(Estimator, FindsWhatIntrinsicsAndLeverArmAreOffBy) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const TestWorldOptions options = miscalibrated(seed);
    const CalibrationVector found = calibration_after(options, 15.0).found;
    const IntrinsicsCorrection off = found.tail<kIntrinsics>() - options.intrinsics_error;
    EXPECT_LT(off.head<4>().cwiseAbs().maxCoeff(), 2e-3) << seed << ": " << off.transpose();
    EXPECT_LT(std::abs(off[kCoefficientsAt]), 6e-3) << seed;
    EXPECT_LT((found.segment<3>(kLeverArmAt) - options.lever_arm_error).norm(), 0.5 * options.lever_arm_error.norm())
        << seed << ": " << found.segment<3>(kLeverArmAt).transpose();
  }
}

/// Motion that does not show them.
TEST(Estimator, LeavesIntrinsicsAndLeverArmWhereNothingShowsThem) {
  for (const TestWorldOptions& options : {TestWorldOptions{.rest_s = 20.0},                                 // at rest
                                          TestWorldOptions{.rest_s = 1.0, .speed = 0.02, .turn = 0.01}}) {  // hover
    const CalibrationVector found = calibration_after(options, 8.0).found;
    EXPECT_LT(found.tail<kIntrinsics>().cwiseAbs().maxCoeff(), 1e-3) << found.transpose();
    EXPECT_LT(found.segment<3>(kLeverArmAt).norm(), 2e-3) << found.transpose();
  }
}

/// An exact calibration, of a lens with distortion: what the motion shows is found right, what it does not show stays
/// within one sigma of the prior (slow motion adds noise to parallax), and its own sigma stays that of the prior.
TEST(Estimator, LeavesAnExactCalibrationInMotionThatShowsPartOfIt) {
  struct Case {
    const char* name;
    TestWorldOptions options;
    bool shows_lens, shows_lever_arm;
  };
  const Case cases[] = {
      {"pure rotation", {.rest_s = 1.0, .speed = 0.0, .turn = 2.0, .tempo = 2.0}, true, false},
      {"slow from the start", {.speed = 0.4, .turn = 0.4, .tempo = 0.8}, false, false},
      {"planar scene", {.rest_s = 1.0, .turn = 1.5, .tempo = 1.5, .near_m = 2.5, .far_m = 2.501}, true, true},
  };
  const CalibrationConfig config;
  for (const auto& [name, base, shows_lens, shows_lever_arm] : cases) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      TestWorldOptions options = base;
      options.pixel_noise = 0.2;
      options.distortion = {-0.37, 0.15, -3e-4, -7e-4, 0.0};
      options.seed = seed;
      const auto [found, sigmas] = calibration_after(options, 12.0);
      EXPECT_LT(found.cwiseQuotient(sigmas).cwiseAbs().maxCoeff(), 3.0) << name << ": " << found.transpose();
      EXPECT_LT(found.segment<4>(kIntrinsicsAt).cwiseAbs().maxCoeff(), shows_lens ? 1.5e-3 : config.focal_sigma)
          << name << ": " << found.transpose();
      EXPECT_LT(found.segment<3>(kLeverArmAt).norm(), 1e-3 * config.lever_arm_sigma_mm)
          << name << ": " << found.transpose();
      if (!shows_lever_arm) {
        EXPECT_GT(sigmas.segment<3>(kLeverArmAt).minCoeff(), 0.5e-3 * config.lever_arm_sigma_mm) << name;
      }
    }
  }
}

/// Errors of the velocity in the body frame, over seeds and time: mean square over reported variance, and RMS.
struct VelocityErrors {
  double nees = 0.0, rms = 0.0;
};

VelocityErrors velocity_errors(const TestWorldOptions& world_options, const EstimatorConfig& config) {
  VelocityErrors sum;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    TestWorldOptions options = world_options;
    options.seed = seed;
    TestWorld world(options);
    Estimator estimator(world.rig(), world.noise(), config);
    for (int i = 1; i <= 160; ++i) {
      const double t = 0.05 * i;
      estimator.add(world.packet(t, 0.05, i % 3 == 0));
      if (!estimator.initialized() || t < 3.0 || i % 10 != 0) continue;
      const OdomState state = estimator.newest();
      const Eigen::Matrix3d R_O_B = state.T_O_B.R();
      const Eigen::Vector3d error = R_O_B.transpose() * state.v_O - world.T_W_B(t).R().transpose() * world.v_W(t);
      const auto P = estimator.covariance();
      if (!P) continue;
      // v_B = R' v_O turns with the attitude.
      Eigen::Matrix<double, 3, 15> J = Eigen::Matrix<double, 3, 15>::Zero();
      J.middleCols<3>(3) = skew(R_O_B.transpose() * state.v_O);
      J.middleCols<3>(6) = R_O_B.transpose();
      sum.nees += error.dot((J * *P * J.transpose()).ldlt().solve(error)) / 3.0;
      sum.rms += error.squaredNorm() / 3.0;
      ++count;
    }
  }
  return {sum.nees / count, std::sqrt(sum.rms / count)};
}

TEST(Estimator, FindsThatWhatATrackHasDriftedByStays) {
  // Without a rest: one determines the gyro bias, which compensates for a part of it.
  const TestWorldOptions drifting{.pixel_noise = 0.05, .pixel_walk = 0.3};
  EstimatorConfig config;
  config.sigma_inflation = 1.0;
  config.calibration = CalibrationConfig::fixed();
  const VelocityErrors with = velocity_errors(drifting, config);
  config.track_noise.correlation = config.track_noise.event_correlation = 0.0;
  const VelocityErrors without = velocity_errors(drifting, config);
  EXPECT_LT(with.rms, 0.85 * without.rms);
  EXPECT_GT(with.nees, 0.3);  // noise_inflation squared is 4, for all cameras
  EXPECT_LT(with.nees, 1.0);
}

/// The factor on the sigma of events after 8 s, beside frames with so many times their noise.
double event_noise_scale(double frames_noise) {
  TestWorld world({.cameras = 2, .pixel_noise = 0.1, .frames_noise = frames_noise});
  Estimator estimator(world.rig(), world.noise(), {});
  for (int i = 1; i <= 160; ++i) estimator.add(world.packet(0.05 * i, 0.05, i % 3 == 0));
  EXPECT_TRUE(estimator.initialized());
  return estimator.window().cameras()[1].noise_scale;
}

TEST(Estimator, TrustsEventsBesideFramesThatAreFarLessAccurate) {
  const double beside_good = event_noise_scale(1.0), beside_bad = event_noise_scale(20.0);
  EXPECT_LT(beside_bad, 0.6 * beside_good);
  EXPECT_GT(beside_bad, 0.3 * beside_good);  // 1 / event_noise_inflation is 0.4
}

TEST(Estimator, GivesTheSameBitsTwice) {
  const RunResult a = run({.rest_s = 1.0}, 5.0), b = run({.rest_s = 1.0}, 5.0);
  EXPECT_EQ(a.max_position_error, b.max_position_error);
  EXPECT_EQ(a.bias_accel, b.bias_accel);
}

TEST(Estimator, KeepsTheWindowBounded) {
  TestWorld world({.rest_s = 1.0});
  const EstimatorConfig config;
  Estimator estimator(world.rig(), world.noise(), config);
  for (int i = 1; i <= 200; ++i) estimator.add(world.packet(i * 0.05, 0.05, i % 2 == 0));
  EXPECT_LE(static_cast<int>(estimator.window().states().size()), config.recent_states + config.keyframes);
  EXPECT_LE(estimator.window().features().size(), 400U);
}

}  // namespace
}  // namespace edged
