// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Camera against gyro: analytic turns (tests/program/cli_recordings_test.py has generated images).
#include "edged/checks/agreement/gyro_agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace edged {
namespace {

/// Angular velocity of a body that shakes about all axes [rad/s].
Eigen::Vector3d shaking(double t) {
  return {0.8 * std::sin(3 * t), 0.6 * std::sin(4.1 * t + 1), 0.5 * std::cos(2.3 * t)};
}

GyroIntegral gyro_of(double seconds, double factor = 1.0) {
  GyroIntegral gyro;
  for (int i = 0; i < seconds * 500; ++i)
    gyro.add({timestamp_from_seconds(i / 500.0), factor * shaking(i / 500.0), {0, 0, 9.81}});
  return gyro;
}

/// The measurements of a camera at 25 Hz, rotated by R_B_C, with a clock that is behind by `offset_s`.
std::vector<Turn> turns_of(double seconds, const Eigen::Matrix3d& R_B_C, double offset_s) {
  std::vector<Turn> turns;
  for (double t = 0.5; t < seconds - 0.5; t += 0.04) {
    Eigen::Vector3d phi = Eigen::Vector3d::Zero();
    for (int i = 0; i < 80; ++i) phi += shaking(t + (i + 0.5) * 0.001) * 0.001;
    turns.push_back(
        {timestamp_from_seconds(t - offset_s), timestamp_from_seconds(t - offset_s + 0.08), R_B_C.transpose() * phi});
  }
  return turns;
}

const Eigen::Matrix3d kTurned = so3::exp({0.3, -1.2, 2.0}).toRotationMatrix();

TEST(GyroAgreement, FindsShiftAndRotationOfAnAnalyticMotion) {
  for (const double offset_s : {0.0, 0.023, -0.061}) {
    const auto found = compare_with_gyro(turns_of(8, kTurned, offset_s), gyro_of(8), Duration(0));
    ASSERT_TRUE(found);
    EXPECT_NEAR(to_seconds(found->time_offset), offset_s, 2e-4);
    EXPECT_LT((found->R_B_C - kTurned).norm(), 2e-3);
    EXPECT_NEAR(found->gyro_scale, 1.0, 2e-3);
    EXPECT_LT(found->unexplained, 0.01);
  }
}

TEST(GyroAgreement, CountsTheTimeOfTurningOnce) {
  const Timestamp begin = timestamp_from_seconds(1);
  const auto turn = [&](int from_ms, int to_ms, double rad_per_s) {
    const std::chrono::milliseconds from(from_ms), to(to_ms);
    return Turn{begin + from, begin + to, Eigen::Vector3d(0, rad_per_s * to_seconds(to - from), 0)};
  };
  EXPECT_EQ(turning_time(std::vector<Turn>()), Duration(0));
  const std::vector<Turn> turns = {turn(0, 80, 0.5), turn(40, 120, 0.5), turn(80, 160, 0.1), turn(200, 280, 0.5)};
  EXPECT_EQ(turning_time(turns), std::chrono::milliseconds(80 + 40 + 80));
  EXPECT_EQ(turning_time(turns, 1), std::chrono::milliseconds(40 + 80)) << "as they come";
}

TEST(GyroAgreement, SearchesAroundTheCalibratedOffsetAndFindsOneThatIsFartherOff) {
  const std::vector<Turn> turns = turns_of(8, kTurned, 0.15);
  const auto found = compare_with_gyro(turns, gyro_of(8), std::chrono::milliseconds(140));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->at_bound);
  EXPECT_NEAR(to_seconds(found->time_offset), 0.15, 2e-4);
  EXPECT_NEAR(to_seconds(compare_with_gyro(turns, gyro_of(8), Duration(0))->time_offset), 0.15, 2e-4);
}

TEST(GyroAgreement, OneWrongTurnInTenDecidesNothing) {
  std::vector<Turn> turns = turns_of(8, kTurned, 0.01);
  for (std::size_t i = 0; i < turns.size(); i += 10) turns[i].phi_C = Eigen::Vector3d(0.5, -0.5, 0.5);
  const auto found = compare_with_gyro(turns, gyro_of(8), Duration(0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(to_seconds(found->time_offset), 0.01, 1e-3);
  EXPECT_LT((found->R_B_C - kTurned).norm(), 1e-2);
}

TEST(GyroAgreement, TellsAGyroWithNegatedAxes) {
  const auto found = compare_with_gyro(turns_of(8, kTurned, 0.01), gyro_of(8, -1.0), Duration(0));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->mirrored);
  EXPECT_FALSE(compare_with_gyro(turns_of(8, kTurned, 0.01), gyro_of(8), Duration(0))->mirrored);
}

/// Turns with corners at 1 to 3 m, of a camera that also moves by up to 0.1 m; rotation vectors with the
/// errors of a single rotation.
std::vector<Turn> turns_with_rays(double seconds, double offset_s) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  // One random number a statement: compilers evaluate arguments in different orders.
  const auto three = [&](auto& distribution) {
    const double z = distribution(random), y = distribution(random), x = distribution(random);
    return Eigen::Vector3d(x, y, z);
  };
  const auto ray = [&](const Eigen::Vector3d& p) {
    const double y = normal(random), x = normal(random);
    return Eigen::Vector3d(p + p.z() * 2e-3 * Eigen::Vector3d(x, y, 0)).normalized();
  };
  std::vector<Turn> turns = turns_of(seconds, kTurned, offset_s);
  for (Turn& turn : turns) {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    const double begin = to_seconds(turn.begin.time_since_epoch()) + offset_s;
    for (int i = 0; i < 80; ++i) q = q * so3::exp(shaking(begin + (i + 0.5) * 1e-3) * 1e-3);
    const SE3 T_begin_end(kTurned.transpose() * q.toRotationMatrix() * kTurned, 0.1 * three(uniform));
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d corner = three(uniform);
      const Eigen::Vector3d p = Eigen::Vector3d(0.6 * corner.x(), 0.45 * corner.y(), 1.0) * (2 + corner.z());
      const Eigen::Vector3d end = ray(T_begin_end.inverse() * p);
      turn.rays.emplace_back(ray(p), end);
    }
    turn.phi_C += three(normal).cwiseProduct(Eigen::Vector3d(0.02, 0.02, 0.002));
  }
  return turns;
}

TEST(GyroAgreement, IsFarBetterFromAllCornersTogetherAndKnowsHowGoodItIs) {
  std::vector<Turn> turns = turns_with_rays(8, 0.01);
  GyroIntegral biased;
  for (int i = 0; i < 8 * 500; ++i)
    biased.add(
        {timestamp_from_seconds(i / 500.0), shaking(i / 500.0) + Eigen::Vector3d(0.05, -0.03, 0.02), {0, 0, 9.81}});
  const auto error = [](const GyroAgreement& found) {
    return so3::log(Eigen::Quaterniond(kTurned.transpose() * found.R_B_C));
  };
  const auto with = compare_with_gyro(turns, biased, Duration(0));
  ASSERT_TRUE(with);
  EXPECT_LT(error(*with).norm(), 0.005);
  EXPECT_LT(error(*with).dot(with->rotation_covariance.inverse() * error(*with)), 16.0);
  EXPECT_LT(with->rotation_sigma, 0.005);
  EXPECT_NEAR(to_seconds(with->time_offset), 0.01, 5e-4);
  EXPECT_NEAR(to_seconds(with->time_offset), 0.01, 3 * with->time_sigma_s);
  EXPECT_GT(with->time_t, 6.0) << "all parts prefer it to an offset of 0";
  EXPECT_LT(compare_with_gyro(turns, biased, std::chrono::milliseconds(10))->time_t, 4.0)
      << "none contradicts a right one";
  EXPECT_LT(with->unexplained, 0.2);
  for (Turn& turn : turns) turn.rays.clear();
  EXPECT_GT(compare_with_gyro(turns, biased, Duration(0))->rotation_sigma, 2 * with->rotation_sigma);
}

TEST(GyroAgreement, TellsAGyroThatReadsATenthTooMuchAndARightOne) {
  const std::vector<Turn> turns = turns_with_rays(8, 0.01);
  for (const double factor : {1.0, 1.1, 0.9}) {
    const auto found = compare_with_gyro(turns, gyro_of(8, factor), Duration(0));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->gyro_scale, factor, 0.02);
    EXPECT_NEAR(found->gyro_scale, factor, 4 * found->scale_sigma);
    EXPECT_LT(found->scale_sigma, 0.01);
  }
}

TEST(GyroAgreement, TellsAGyroInDegrees) {
  const auto found = compare_with_gyro(turns_of(8, kTurned, 0.0), gyro_of(8, 180 / M_PI), Duration(0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->gyro_scale, 180 / M_PI, 0.5);
}

/// The angle by which turns with so much noise contradict a camera of that mounting.
double gross_deg(unsigned seed, const GyroIntegral& gyro, std::vector<Turn> turns, double noise_rad_s,
                 const Eigen::Matrix3d& R_B_C) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise_rad_s * 0.08);
  for (Turn& turn : turns)
    for (double& phi : turn.phi_C) phi += normal(random);
  const auto found = compare_with_gyro(turns, gyro, Duration(0));
  const RigCamera given{"events", Modality::Events, {}, SE3(R_B_C, Eigen::Vector3d::Zero()), Duration(0)};
  return found ? grossly_off_deg(turns, gyro, given, *found) : 0.0;
}

TEST(GyroAgreement, NoisyTurnsTellACameraThatIsMountedAQuarterTurnOffButNotARightOne) {
  const Eigen::Matrix3d off = kTurned * so3::exp({0, 0, M_PI / 2}).toRotationMatrix();
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    EXPECT_NEAR(gross_deg(seed, gyro_of(8), turns_of(8, kTurned, 0.0), 0.6, off), 90.0, 15.0);
    EXPECT_EQ(gross_deg(seed, gyro_of(8), turns_of(8, kTurned, 0.0), 0.6, kTurned), 0.0);
  }
}

TEST(GyroAgreement, TurnsOfNoiseAlonePointToNoMounting) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U})
    EXPECT_EQ(gross_deg(seed, gyro_of(8, 0.02), turns_of(8, Eigen::Matrix3d::Zero(), 0.0), 0.4, kTurned), 0.0);
}

TEST(GyroAgreement, SaysNothingOfTooFewTurnsOrOtherTimes) {
  const std::vector<Turn> turns = turns_of(8, kTurned, 0.0);
  EXPECT_FALSE(compare_with_gyro(std::span(turns).first(10), gyro_of(8), Duration(0)));
  EXPECT_FALSE(compare_with_gyro(turns, GyroIntegral(), Duration(0)));
  EXPECT_FALSE(compare_with_gyro(turns_of(8, kTurned, 100.0), gyro_of(8), Duration(0)));
}

TEST(GyroIntegral, HasNothingAcrossAGapOrBeyondItsEnds) {
  GyroIntegral gyro;
  for (const double t : {0.0, 0.01, 0.02, 0.5, 0.51}) gyro.add({.t = timestamp_from_seconds(t), .gyro_B = {1, 0, 0}});
  const auto between = [&](double a, double b) {
    return gyro.between(timestamp_from_seconds(a), timestamp_from_seconds(b));
  };
  EXPECT_NEAR(between(0.005, 0.015)->x(), 0.01, 1e-12);
  EXPECT_FALSE(between(0.015, 0.505));
  EXPECT_FALSE(between(-0.1, 0.01));
  EXPECT_FALSE(between(0.5, 0.6));
}

}  // namespace
}  // namespace edged
