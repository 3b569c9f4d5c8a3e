// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/motion/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "edged/core/check.hpp"
#include "edged/core/test_data.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/sim/motion/motion.hpp"
#include "edged/sim/motion/test_derivatives.hpp"
#include "edged/sim/sensors/imu_model.hpp"

namespace edged {
namespace {

const MotionConfig kLively{.file = {}, .max_angle_deg = 60.0, .max_speed = 1.5, .max_rate_deg_s = 150.0};

TEST(ContinuousTrajectory, DerivativesAgreeWithDifferences) {
  const ContinuousTrajectory trajectory = make_motion(kLively, 6.0, SE3(), 3);
  for (double t = 0.501; t < 5.5; t += 0.0737) expect_derivatives_at(t, trajectory, {.step_s = 1e-4, .a_W = 1e-4});
}

TEST(ContinuousTrajectory, RestsAtFirstAndThenReachesItsPeaks) {
  const ContinuousTrajectory trajectory = make_motion(kLively, 20.0, SE3(), 3);
  double speed = 0.0, rate = 0.0;
  for (double t = 0.0; t <= 20.0; t += 0.01) {
    const Kinematics k = trajectory.at(t);
    if (t <= 1.0) {
      EXPECT_EQ(k.v_W.norm() + k.a_W.norm() + k.omega_B.norm(), 0.0);
    }
    speed = std::max(speed, k.v_W.norm());
    rate = std::max(rate, k.omega_B.norm());
  }
  EXPECT_NEAR(speed, 1.5, 0.15);
  EXPECT_NEAR(rate, 150.0 * M_PI / 180.0,
              0.6);  // rate of the three angles, which differs slightly from the angular rate
}

TEST(PoseSpline, IgnoresOutliers) {
  const ContinuousTrajectory truth = make_motion(kLively, 6.0, SE3(), 4);
  Trajectory samples;
  for (int i = 200; i <= 1200; ++i) {
    SE3 T = truth.at(i * 0.005).T_W_B;
    if (i % 97 == 0) T = T * SE3(so3::exp({0.3, 0.0, 0.0}), Eigen::Vector3d(0.5, 0.0, 0.0));
    samples.push_back({timestamp_from_seconds(i * 0.005), T});
  }
  const PoseSpline spline = PoseSpline::fit(samples, {});
  for (double s = 0.1; s < 4.9; s += 0.01) {
    const SE3 error = spline.at(s).T_W_B.inverse() * truth.at(1.0 + s).T_W_B;
    EXPECT_LT(error.translation().norm(), 0.002) << s;
    EXPECT_LT(so3::log(error.rotation()).norm(), 0.002) << s;
  }
}

TEST(PoseSpline, RefusesStampsThatDoNotIncrease) {
  EXPECT_THROW(PoseSpline::fit(Trajectory(20), {}), InputError);
  EXPECT_THROW(PoseSpline::fit(Trajectory(3), {}), InputError);
}

TEST(ImuModel, IntegratesToTheTrueTrajectory) {
  const ContinuousTrajectory trajectory = make_motion(kLively, 8.0, SE3(), 5);
  ImuModelConfig config;
  config.gyro_noise = config.accel_noise = config.gyro_bias = config.accel_bias = config.gyro_walk = config.accel_walk =
      0.0;
  ImuModel imu(config, 1);
  constexpr double kStart = 4.0;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 2000; ++i)
    samples.push_back(imu.measure(timestamp_from_seconds(kStart + i * 1e-3), trajectory.at(kStart + i * 1e-3)));
  const Kinematics begin = trajectory.at(kStart), end = trajectory.at(kStart + 2.0);
  OdomState state{.t = samples.front().t, .T_O_B = begin.T_W_B, .v_O = begin.v_W};
  state = propagate(state, Preintegration(samples, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), config.noise()));
  EXPECT_LT((state.T_O_B.translation() - end.T_W_B.translation()).norm(), 1e-3);
  EXPECT_LT((state.v_O - end.v_W).norm(), 1e-3);
  EXPECT_LT(so3::log(state.T_O_B.rotation().conjugate() * end.T_W_B.rotation()).norm(), 1e-4);
}

TEST(ImuModel, MeasuresGravityUpwardsAtRestWithItsBiases) {
  ImuModelConfig config;
  config.gyro_noise = config.accel_noise = 0.0;
  ImuModel imu(config, 2);
  const Eigen::Vector3d bias_gyro = imu.bias_gyro(), bias_accel = imu.bias_accel();
  const ImuSample sample = imu.measure(Timestamp(), Kinematics());
  EXPECT_NEAR(bias_accel.norm(), config.accel_bias, 1e-12);
  EXPECT_LT((sample.gyro_B - bias_gyro).norm(), 1e-12);
  EXPECT_LT((sample.accel_B - bias_accel - Eigen::Vector3d(0, 0, 9.81)).norm(), 1e-12);
}

TEST(ImuModel, ShakesWithItsMotorsAtTheirFrequencyOnly) {
  ImuModelConfig config;
  config.gyro_noise = config.accel_noise = config.accel_walk = config.gyro_walk = 0.0;
  config.accel_vibration = 2.0;
  config.motors_on_s = 1.0, config.motors_off_s = 5.0;
  ImuModel imu(config, 2);
  const Eigen::Vector3d still = imu.bias_accel() + Eigen::Vector3d(0, 0, 9.81);
  double squares = 0.0, sum = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const Timestamp t = timestamp_from_seconds(1e-3 * i + 0.0024);
    const Eigen::Vector3d shaken = imu.measure(t, Kinematics()).accel_B - still;
    if (i < 1000 || i >= 5003) {
      ASSERT_LT(shaken.norm(), 1e-9) << i;
    } else if (i >= 1500 && i < 4500) {
      squares += shaken.squaredNorm() / 3.0, sum += shaken.x();
    }
  }
  EXPECT_NEAR(std::sqrt(squares / 3000.0), 2.0 * std::sqrt(1.25), 0.4);
  EXPECT_NEAR(sum / 3000.0, 0.0, 0.05);  // its integral is zero
}

TEST(ImuModel, ReadsNoMoreThanItsRange) {
  ImuModelConfig config;
  config.gyro_range = 2.0;
  ImuModel imu(config, 2);
  Kinematics spinning;
  spinning.omega_B = {5.0, -5.0, 0.5};
  const ImuSample sample = imu.measure(Timestamp(), spinning);
  EXPECT_EQ(sample.gyro_B.x(), 2.0);
  EXPECT_EQ(sample.gyro_B.y(), -2.0);
  EXPECT_NEAR(sample.gyro_B.z(), 0.5, 0.1);
  EXPECT_EQ(config.noise().gyro_saturation, 2.0);
}

TEST(RecordedMotion, StaysCloseToItsSourceWithSaneAccelerations) {
  const std::filesystem::path folder = data_folder() / "ecd" / "groundtruth";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path());
    const MotionConfig config{.file = entry.path(), .start_s = 8.0};
    const ContinuousTrajectory trajectory = make_motion(config, 20.0, SE3(), 1);
    const Trajectory source = read_tum(entry.path());
    double squares = 0.0, fastest = 0.0;
    int count = 0;
    const Timestamp begin = source.front().t + duration_from_seconds(config.start_s);
    const auto first =
        std::find_if(source.begin(), source.end(), [&](const StampedPose& pose) { return pose.t >= begin; });
    for (const StampedPose& pose : source) {
      const double t = to_seconds(pose.t - first->t) + config.rest_s + 0.5 * config.blend_s;
      if (t < 2.0 || t > 20.0) continue;
      const Kinematics k = trajectory.at(t);
      squares += (k.T_W_B.translation() - pose.T.translation()).squaredNorm();
      fastest = std::max(fastest, k.a_W.norm());
      ++count;
    }
    ASSERT_GT(count, 3000);
    EXPECT_LT(std::sqrt(squares / count), 0.005);
    EXPECT_LT(fastest, 30.0);
  }
}

}  // namespace
}  // namespace edged
