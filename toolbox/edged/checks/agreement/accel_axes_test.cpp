// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/accel_axes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "edged/state.hpp"

namespace edged {
namespace {

/// The result for a body that rotates about all axes and vibrates, with its accelerometer's axes changed by M.
std::optional<std::string> said_of(const Eigen::Matrix3d& M) {
  AccelAxes axes;
  Eigen::Quaterniond q_W_B = Eigen::Quaterniond::Identity();
  constexpr double kStep = 0.005;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * kStep;
    const Eigen::Vector3d gyro(0.5 * std::sin(1.1 * t), 0.6 * std::cos(0.7 * t), 0.4 * std::sin(1.7 * t + 1.0));
    const Eigen::Vector3d shaken(2.0 * std::sin(9.0 * t), 1.5 * std::cos(5.0 * t), std::sin(7.0 * t));
    axes.add({timestamp_from_seconds(t), gyro, M * (q_W_B.conjugate() * (shaken - kGravity_W))});
    q_W_B = q_W_B * so3::exp(gyro * kStep);
  }
  return axes.better();
}

TEST(AccelAxes, SaysNothingOfRightAxes) {
  EXPECT_EQ(said_of(Eigen::Matrix3d::Identity()), std::nullopt);
  EXPECT_EQ(said_of(-Eigen::Matrix3d::Identity()), std::nullopt);
  EXPECT_EQ(AccelAxes().better(), std::nullopt);
}

TEST(AccelAxes, NamesThoseWithTheWrongSign) {
  EXPECT_EQ(said_of(Eigen::Vector3d(-1, 1, 1).asDiagonal()), "(-x, y, z)");
  EXPECT_EQ(said_of(Eigen::Vector3d(-1, -1, 1).asDiagonal()), "(-x, -y, z)");
}

TEST(AccelAxes, NamesThoseThatAreExchanged) {
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(said_of(quarter), "(y, -x, z)");
  quarter << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  EXPECT_EQ(said_of(quarter), "(x, z, -y)");
}

}  // namespace
}  // namespace edged
