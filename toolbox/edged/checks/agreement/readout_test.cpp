// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corners of a camera that shakes and moves, each seen at the instant of its row.
#include "edged/checks/agreement/readout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace edged {
namespace {

constexpr double kStep = 1e-3, kSeconds = 8.0;
const Eigen::Matrix3d kR_B_C = so3::exp({0.3, -1.2, 2.0}).toRotationMatrix();
const CameraModel kCamera(240, 180, 200, 200, 120, 90, DistortionModel::None, {});

/// An analytic motion, sampled.
class ShakenCamera {
 public:
  ShakenCamera() {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    for (double t = 0.0; t < kSeconds; t += kStep) {
      attitude_.push_back(q);
      const Eigen::Vector3d rate(0.8 * std::sin(3 * t), 0.6 * std::sin(4.1 * t + 1), 0.5 * std::cos(2.3 * t));
      gyro.add({timestamp_from_seconds(t), rate, {0, 0, 9.81}});
      q = (q * so3::exp(rate * kStep)).normalized();
    }
  }

  /// Where the camera sees a point, by the instant of its row.
  Eigen::Vector3d ray(const Eigen::Vector3d& p_W, double t, double readout_s) const {
    double row = 0.0;
    Eigen::Vector3d p_C;
    for (int round = 0; round < 4; ++round) {
      p_C = at(t + row * readout_s).inverse() * p_W;
      row = std::clamp(kCamera.distort_to_pixel(p_C.hnormalized()).y() / kCamera.height() - 0.5, -0.5, 0.5);
    }
    return p_C.normalized();
  }
  SE3 at(double t) const {
    const Eigen::Matrix3d R_W_B = attitude_.at(static_cast<std::size_t>(std::lround(t / kStep))).toRotationMatrix();
    return {R_W_B * kR_B_C, 0.1 * Eigen::Vector3d(std::sin(2 * t), std::cos(1.7 * t), std::sin(1.3 * t))};
  }

  GyroIntegral gyro;

 private:
  std::vector<Eigen::Quaterniond> attitude_;
};

std::vector<Turn> turns_of(const ShakenCamera& camera, double readout_s) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Turn> turns;
  for (double t = 0.5; t < kSeconds - 0.5; t += 0.04) {
    Turn turn{timestamp_from_seconds(t), timestamp_from_seconds(t + 0.08)};
    for (int i = 0; i < 40; ++i) {
      const double x = uniform(random), y = uniform(random), depth = 1.0 + 2.0 * uniform(random);
      const Eigen::Vector3d p_C = depth * kCamera.pixel_to_point({240 * x, 180 * y}).homogeneous();
      const Eigen::Vector3d p_W = camera.at(t) * p_C;
      turn.rays.emplace_back(camera.ray(p_W, t, readout_s), camera.ray(p_W, t + 0.08, readout_s));
    }
    turns.push_back(std::move(turn));
  }
  return turns;
}

TEST(Readout, IsFoundInAnAnalyticMotion) {
  const ShakenCamera camera;
  GyroAgreement mount;
  mount.R_B_C = kR_B_C;
  for (const double readout_s : {0.0, 0.03, -0.02}) {
    const auto found = readout_of(turns_of(camera, readout_s), camera.gyro, kCamera, mount);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->s, readout_s, 2e-3);
    EXPECT_LT(found->sigma_s, 2e-3);
  }
}

TEST(Readout, NeedsCorners) {
  EXPECT_FALSE(readout_of({}, ShakenCamera().gyro, kCamera, {}));
  EXPECT_FALSE(readout_of(std::vector<Turn>(100, {timestamp_from_seconds(1), timestamp_from_seconds(1.1)}),
                          ShakenCamera().gyro, kCamera, {}));
}

}  // namespace
}  // namespace edged
