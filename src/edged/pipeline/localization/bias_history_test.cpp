// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/bias_history.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

constexpr double kGyroSigma = 0.003;  // [rad/s]
constexpr double kAccelSigma = 0.03;  // [m/s^2]

class BiasHistoryTest : public testing::Test {
 protected:
  double add(double t_s, double gyro, double accel) {
    OdomState state;
    state.t = timestamp_from_seconds(t_s);
    state.bias_gyro.y() = gyro;
    state.bias_accel.z() = accel;
    Matrix15d P = Matrix15d::Identity();
    P.diagonal().segment<3>(9).setConstant(kGyroSigma * kGyroSigma);
    P.diagonal().segment<3>(12).setConstant(kAccelSigma * kAccelSigma);
    return history_.add(state, P);
  }

  BiasHistory history_{ImuNoise{}};
};

TEST_F(BiasHistoryTest, CountsSigmasOfTheTimeBefore) {
  EXPECT_EQ(add(0.0, 0.01, 0.1), 0.0);
  EXPECT_LT(add(0.1, 0.01 + kGyroSigma, 0.1 - kAccelSigma), 1.0);
  EXPECT_GT(add(0.2, 0.01, 0.1 + 4.0 * kAccelSigma), 3.0);
  EXPECT_GT(add(0.3, 0.01 - 5.0 * kGyroSigma, 0.1), 3.0);
}

TEST_F(BiasHistoryTest, AllowsSlowDrift) {
  for (double t = 0.0; t < 60.0; t += 0.1) EXPECT_LT(add(t, 0.0, 0.005 * t), 2.0) << t;
}

TEST_F(BiasHistoryTest, ForgetsWhatIsLongPast) {
  add(0.0, 0.0, 0.0);
  EXPECT_EQ(add(11.0, 0.0, 1.0), 0.0);
}

TEST_F(BiasHistoryTest, GivesAPriorOfTheOldestAndTheNewest) {
  EXPECT_FALSE(history_.oldest() || history_.newest());
  for (double t = 0.0; t < 12.0; t += 0.5) add(t, 1e-4 * t, 0.0);
  EXPECT_NEAR(history_.oldest()->gyro.y(), 1e-4 * 1.5, 1e-9);
  EXPECT_NEAR(history_.newest()->gyro.y(), 1e-4 * 11.5, 1e-9);
  EXPECT_GT(history_.newest()->gyro_sigma, kGyroSigma) << "it drifts until the next start";
  EXPECT_LT(history_.newest()->gyro_sigma, 2.0 * kGyroSigma);
  EXPECT_GT(history_.newest()->accel_sigma, kAccelSigma);
}

}  // namespace
}  // namespace edged
