// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A body that swings and rotates, with sensors of wrong mounting, sign or scale.
#include "edged/checks/agreement/external_agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace edged {
namespace {

using Eigen::Vector3d;

constexpr double kLength_s = 20.0;

Vector3d swing_position(double t) {
  return {0.8 * std::sin(1.1 * t), 0.6 * std::sin(1.7 * t + 1.0), 0.5 * std::sin(1.4 * t + 2.0)};
}
Vector3d swing_velocity(double t) { return (swing_position(t + 1e-4) - swing_position(t - 1e-4)) / 2e-4; }
Vector3d swing_acceleration(double t) {
  return (swing_position(t + 1e-3) - 2.0 * swing_position(t) + swing_position(t - 1e-3)) / 1e-6;
}
Eigen::Quaterniond swing_attitude(double t) {
  return so3::exp({0.3 * std::sin(0.9 * t), 0.2 * std::sin(1.3 * t), 0.6 * std::sin(0.7 * t)});
}
Vector3d swing_rate(double t) { return so3::log(swing_attitude(t - 1e-4).inverse() * swing_attitude(t + 1e-4)) / 2e-4; }

class SensorsOnABody : public ::testing::Test {
 protected:
  SensorsOnABody() {
    for (int i = 0; i < kLength_s * 200; ++i) {
      const double t = i / 200.0;
      gyro_.add(
          {timestamp_from_seconds(t), swing_rate(t),
           swing_attitude(t).inverse() * (swing_acceleration(t) + Vector3d(0, 0, 9.81)) + Vector3d(0.05, -0.03, 0.04)});
    }
  }

  double noise(double sigma) { return std::normal_distribution(0.0, sigma)(random_); }

  std::vector<HeightSample> heights(double scale) {
    std::vector<HeightSample> samples;
    for (double t = 0.1; t < kLength_s - 0.1; t += 0.04)
      samples.push_back({timestamp_from_seconds(t), 12.0 + scale * swing_position(t).z() + noise(0.1), 0.1});
    return samples;
  }

  /// measured: the output of the sensor for a velocity of the body in the body frame.
  std::vector<VelocitySample> velocities(const Eigen::Matrix3d& measured, const Vector3d& sigma = {0.05, 0.05, 0.05}) {
    std::vector<VelocitySample> samples;
    for (double t = 0.1; t < kLength_s - 0.1; t += 0.04) {
      const Vector3d v_B =
          swing_attitude(t).inverse() * swing_velocity(t) + swing_rate(t).cross(Vector3d(0.1, -0.05, 0.0));
      samples.push_back(
          {timestamp_from_seconds(t), measured * v_B + Vector3d(noise(0.05), noise(0.05), noise(0.05)), sigma});
    }
    return samples;
  }

  bool says(const std::vector<VelocitySample>& samples, const std::string& text, Severity severity) {
    ExternalCheck check;
    ExternalCollector collector;
    for (const VelocitySample& sample : samples) check.add(sample), collector.add(sample);
    std::vector<Finding> findings;
    check.judge(gyro_, {{"velocity", collector.result()}}, findings);
    for (const Finding& f : findings) std::printf("%s: %s\n", f.text.c_str(), f.remedy.c_str());
    return std::ranges::any_of(findings, [&](const Finding& finding) {
      return finding.severity == severity && (finding.text + ": " + finding.remedy).find(text) != std::string::npos;
    });
  }

  GyroIntegral gyro_;
  std::mt19937_64 random_{3};
};

const Eigen::Matrix3d kAsIs = Eigen::Matrix3d::Identity();

TEST_F(SensorsOnABody, HeightsTellTheirSignAndTheirScale) {
  for (const double scale : {1.0, -1.0, 3.28, 0.5}) {
    const auto found = compare_heights(heights(scale), gyro_);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->scale, scale, 0.1 * std::abs(scale));
  }
}

TEST_F(SensorsOnABody, AHeightThatIsADepthIsAnError) {
  ExternalCheck check;
  for (const HeightSample& sample : heights(-1.0)) check.add(sample);
  std::vector<Finding> findings;
  check.judge(gyro_, {}, findings);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::Error);
}

TEST_F(SensorsOnABody, AVelocityThatFitsIsGood) {
  EXPECT_TRUE(says(velocities(kAsIs), "agree with the IMU", Severity::Good));
  const auto found = compare_velocities(velocities(kAsIs), gyro_, 0.05);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 1.0, 0.05);
  EXPECT_LT((found->T_B_S.translation() - Vector3d(0.1, -0.05, 0.0)).norm(), 0.1);
}

TEST_F(SensorsOnABody, TurnedAxesAreFoundWithTheOptionThatMendsThem) {
  const Eigen::Matrix3d yaw = so3::exp(Vector3d(0, 0, EIGEN_PI / 2)).toRotationMatrix(),
                        roll = so3::exp(Vector3d(-EIGEN_PI / 2, 0, 0)).toRotationMatrix();
  EXPECT_TRUE(says(velocities(yaw.transpose()), "rotation_deg=\"0 0 90\"", Severity::Warning));
  EXPECT_TRUE(says(velocities(roll.transpose()), "rotation_deg=\"-90 0 0\"", Severity::Warning));
}

TEST_F(SensorsOnABody, WrongSignsAreFound) {
  EXPECT_TRUE(says(velocities(-kAsIs), "vx, vy, vz", Severity::Error));
  EXPECT_TRUE(says(velocities(Vector3d(1, -1, 1).asDiagonal() * kAsIs), "the sign of vy", Severity::Error));
}

TEST_F(SensorsOnABody, OtherUnitsAreNamed) {
  EXPECT_TRUE(says(velocities(3.6 * kAsIs), "vx[km/h]", Severity::Warning));
  EXPECT_TRUE(says(velocities(1.3 * kAsIs), "velocity.scale_sigma", Severity::Warning));
}

TEST_F(SensorsOnABody, AForwardAxisAloneTellsItsSignAndScale) {
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(says(velocities(kAsIs, {0.05, none, none}), "agree with the IMU", Severity::Good));
  EXPECT_TRUE(says(velocities(-kAsIs, {0.05, none, none}), "rotation_deg", Severity::Warning));
}

TEST_F(SensorsOnABody, ASensorAtRestTellsNothing) {
  std::vector<VelocitySample> still;
  for (double t = 0.1; t < kLength_s; t += 0.04)
    still.push_back({timestamp_from_seconds(t), Vector3d(noise(0.05), noise(0.05), noise(0.05)), {0.05, 0.05, 0.05}});
  GyroIntegral gyro;
  for (int i = 0; i < kLength_s * 200; ++i)
    gyro.add({timestamp_from_seconds(i / 200.0), Vector3d::Zero(), Vector3d(0, 0, 9.81)});
  EXPECT_FALSE(compare_velocities(still, gyro, 0.05));
}

}  // namespace
}  // namespace edged
