// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/accel_agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "edged/se3.hpp"

namespace edged {
namespace {

constexpr double kStep_s = 0.002;
const Eigen::Matrix3d kMount = so3::exp({0.3, -1.2, 2.0}).toRotationMatrix();

Eigen::Vector3d turning(double t) {
  return {0.5 * std::sin(3 * t), 0.4 * std::sin(4.1 * t + 1), 0.3 * std::cos(2.3 * t)};
}
Eigen::Vector3d place_at(double t) {
  return {0.30 * std::sin(3 * t), 0.25 * std::sin(2.2 * t + 1), 0.20 * std::cos(2.7 * t)};
}
Eigen::Vector3d acceleration(double t) {
  return (place_at(t + kStep_s) - 2 * place_at(t) + place_at(t - kStep_s)) / (kStep_s * kStep_s);
}

/// A flight of 12 s: IMU samples with the given sign of the accelerometer, and the rotations of a camera.
struct Flown {
  GyroIntegral imu;
  std::vector<Turn> turns;
};

Flown fly(double sign) {
  Flown flown;
  std::vector<SE3> T_W_B;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (double t = 0.0; t < 12.0; t += kStep_s) {
    T_W_B.emplace_back(q, place_at(t));
    const Eigen::Vector3d force = q.conjugate() * (acceleration(t) + Eigen::Vector3d(0, 0, 9.81));
    flown.imu.add({timestamp_from_seconds(t), turning(t), sign * force});
    q = (q * so3::exp(turning(t + kStep_s / 2) * kStep_s)).normalized();
  }
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 1e-3);
  const SE3 T_B_C(kMount, Eigen::Vector3d::Zero());
  for (std::size_t i = 500; i + 540 < T_W_B.size(); i += 20) {
    const SE3 T_begin_end = (T_W_B[i] * T_B_C).inverse() * (T_W_B[i + 40] * T_B_C);
    const auto at = [](std::size_t k) { return timestamp_from_seconds(static_cast<double>(k) * kStep_s); };
    Turn turn{at(i), at(i + 40)};
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector3d p(uniform(random), 0.7 * uniform(random), 2.0 + 0.5 * uniform(random));
      const auto ray = [&](const Eigen::Vector3d& x) {
        return Eigen::Vector3d(x + x.z() * Eigen::Vector3d(noise(random), noise(random), 0)).normalized();
      };
      turn.rays.emplace_back(ray(p), ray(T_begin_end.inverse() * p));
    }
    flown.turns.push_back(turn);
  }
  return flown;
}

TEST(AccelAgreement, TellsTheSignOfAnAccelerometer) {
  for (const double sign : {1.0, -1.0}) {
    const Flown flown = fly(sign);
    const AccelAgreement found = compare_with_accel(flown.turns, flown.imu, {kMount});
    EXPECT_GT(found.turns, 100U);
    EXPECT_GT(sign * found.correlation, 0.6);
  }
}

TEST(AccelAgreement, SaysNothingOfACameraThatOnlyTurns) {
  Flown flown = fly(1.0);
  for (Turn& turn : flown.turns) turn.rays.clear();
  EXPECT_EQ(compare_with_accel(flown.turns, flown.imu, {kMount}).turns, 0U);
}

}  // namespace
}  // namespace edged
