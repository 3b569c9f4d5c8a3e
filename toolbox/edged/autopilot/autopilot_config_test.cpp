// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/autopilot_config.hpp"

#include <gtest/gtest.h>

#include "edged/input_error.hpp"

namespace edged {
namespace {

Eigen::Matrix3d R_V_B_of(const std::string& axes) { return AutopilotConfig{.axes = axes}.R_V_B().toRotationMatrix(); }

Eigen::Matrix3d rows(const Eigen::Vector3d& forward, const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
  Eigen::Matrix3d R;
  R << forward.transpose(), right.transpose(), down.transpose();
  return R;
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(), kZ = Eigen::Vector3d::UnitZ();

TEST(AutopilotConfig, MountsTheImuByDefaultForwardLeftUp) {
  EXPECT_LT((AutopilotConfig{}.R_V_B().toRotationMatrix() - rows(kX, -kY, -kZ)).norm(), 1e-12);
}

TEST(AutopilotConfig, TwoAxesGiveTheThird) {
  for (const char* axes :
       {"forward=z up=-y", "up=-y, forward=+z", "back=-z down=y", "right=x down=y", "left=-x forward=z"})
    EXPECT_LT((R_V_B_of(axes) - rows(kZ, kX, kY)).norm(), 1e-12) << axes;
  EXPECT_LT((R_V_B_of("forward=x down=z") - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(AutopilotConfig, AnglesAreThoseOfTheImuInForwardLeftUp) {
  EXPECT_LT((R_V_B_of("0 0 0") - rows(kX, -kY, -kZ)).norm(), 1e-12);
  // Turned to the left by 90 degrees: the IMU's x points left, its y back.
  EXPECT_LT((R_V_B_of("0 0 90") - rows(-kY, -kX, -kZ)).norm(), 1e-12);
  // Nose down by 30 degrees: its x points forward and down.
  const Eigen::Vector3d x_V = R_V_B_of("0 30 0") * kX;
  EXPECT_LT((x_V - Eigen::Vector3d(std::sqrt(0.75), 0.0, 0.5)).norm(), 1e-12);
}

TEST(AutopilotConfig, RefusesWhatIsNoMounting) {
  for (const char* axes : {"forward=x", "forward=x up=x", "forward=x back=y", "forward=x up=w", "forward=x left=y up=z",
                           "forward=x up=", "=", "forward=x upwards=z", "", "0 0", "0 0 x"})
    EXPECT_THROW(R_V_B_of(axes), InputError) << axes;
}

}  // namespace
}  // namespace edged
