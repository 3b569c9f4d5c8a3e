// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu/preintegration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

const Vector3d kNoBias = Vector3d::Zero();
constexpr Duration kMillisecond = std::chrono::milliseconds(1);

/// A motion known in closed form, time in seconds.
struct Motion {
  std::function<Quaterniond(double)> attitude;                       // R_O_B
  std::function<Vector3d(double)> position, velocity, acceleration;  // in O
  std::function<Vector3d(double)> rate;                              // in B

  ImuSample sample(double t) const {
    return {timestamp_from_seconds(t), rate(t), attitude(t).conjugate() * (acceleration(t) - kGravity_W)};
  }
  std::vector<ImuSample> samples(double from, double to, Duration interval) const {
    std::vector<ImuSample> all;
    for (Timestamp t = timestamp_from_seconds(from); t <= timestamp_from_seconds(to); t += interval) {
      all.push_back(sample(to_seconds(t)));
    }
    return all;
  }
  OdomState state(double t) const {
    return {timestamp_from_seconds(t), {attitude(t), position(t)}, velocity(t), kNoBias, kNoBias};
  }
};

Quaterniond about(const Vector3d& axis, double angle) { return so3::exp(angle * axis); }

/// A circle of 0.8 m at 1.5 rad/s that climbs, the body turning with it.
Motion helix() {
  constexpr double kRadius = 0.8, kRate = 1.5, kClimb = 0.3;
  return {
      .attitude = [=](double t) { return about(Vector3d::UnitZ(), kRate * t); },
      .position =
          [=](double t) { return Vector3d(kRadius * std::cos(kRate * t), kRadius * std::sin(kRate * t), kClimb * t); },
      .velocity =
          [=](double t) {
            return Vector3d(-kRadius * kRate * std::sin(kRate * t), kRadius * kRate * std::cos(kRate * t), kClimb);
          },
      .acceleration = [=](double t) -> Vector3d {
        return -kRadius * kRate * kRate * Vector3d(std::cos(kRate * t), std::sin(kRate * t), 0.0);
      },
      .rate = [=](double) -> Vector3d { return kRate * Vector3d::UnitZ(); }};
}

/// Three angles that swing at different frequencies (the axes do not commute), on a wavy path.
Motion tumbling() {
  const auto yaw = [=](double t) { return 0.9 * std::sin(2.0 * t); };
  const auto pitch = [=](double t) { return 0.5 * std::sin(3.0 * t + 0.4); };
  const auto roll = [=](double t) { return 0.7 * std::sin(2.5 * t + 1.0); };
  return {
      .attitude =
          [=](double t) {
            return about(Vector3d::UnitZ(), yaw(t)) * about(Vector3d::UnitY(), pitch(t)) *
                   about(Vector3d::UnitX(), roll(t));
          },
      .position = [=](double t) { return Vector3d(std::sin(1.1 * t), 0.5 * std::sin(2.3 * t), 0.2 * std::cos(3 * t)); },
      .velocity =
          [=](double t) { return Vector3d(1.1 * std::cos(1.1 * t), 1.15 * std::cos(2.3 * t), -0.6 * std::sin(3 * t)); },
      .acceleration =
          [=](double t) {
            return Vector3d(-1.21 * std::sin(1.1 * t), -2.645 * std::sin(2.3 * t), -1.8 * std::cos(3 * t));
          },
      .rate = [=](double t) -> Vector3d {
        const double d_yaw = 1.8 * std::cos(2.0 * t), d_pitch = 1.5 * std::cos(3.0 * t + 0.4),
                     d_roll = 1.75 * std::cos(2.5 * t + 1.0);
        const Quaterniond roll_back = about(Vector3d::UnitX(), -roll(t));
        const Quaterniond pitch_back = about(Vector3d::UnitY(), -pitch(t));
        return d_roll * Vector3d::UnitX() + roll_back * (d_pitch * Vector3d::UnitY()) +
               roll_back * (pitch_back * (d_yaw * Vector3d::UnitZ()));
      }};
}

struct MotionError {
  double attitude, velocity, position;
};

/// Error of the state predicted for the end of the second that begins at t = 0.3 s.
MotionError propagation_error(const Motion& motion, Duration interval) {
  const Preintegration integrated(motion.samples(0.3, 1.3, interval), kNoBias, kNoBias, {});
  const OdomState end = propagate(motion.state(0.3), integrated);
  const OdomState truth = motion.state(1.3);
  EXPECT_EQ(end.t, truth.t);
  return {so3::log(truth.T_O_B.rotation().conjugate() * end.T_O_B.rotation()).norm(), (end.v_O - truth.v_O).norm(),
          (end.T_O_B.translation() - truth.T_O_B.translation()).norm()};
}

double gaussian(std::mt19937_64& generator) {
  const auto share = [&generator] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
  const double radius = std::sqrt(-2.0 * std::log(1.0 - share()));
  return radius * std::cos(2.0 * std::numbers::pi * share());
}

Vector3d gaussian_vector(std::mt19937_64& generator) {
  const double x = gaussian(generator), y = gaussian(generator), z = gaussian(generator);
  return {x, y, z};
}

TEST(Preintegration, IsExactForAConstantRate) {
  const Vector3d rate(0.4, -1.1, 2.0);
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 200; ++i) samples.push_back({Timestamp(5 * i * kMillisecond), rate, Vector3d::Zero()});
  const Preintegration integrated(samples, kNoBias, kNoBias, {});
  EXPECT_NEAR(integrated.dt(), 1.0, 1e-12);
  EXPECT_LT(so3::log(so3::exp(rate).conjugate() * integrated.dR(kNoBias)).norm(), 1e-13);
}

TEST(Preintegration, IsExactForAConstantAcceleration) {
  const Vector3d accel(0.5, -2.0, 9.0), bias(0.1, 0.2, -0.3);
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 200; ++i) samples.push_back({Timestamp(5 * i * kMillisecond), Vector3d::Zero(), accel + bias});
  const Preintegration integrated(samples, kNoBias, bias, {});
  EXPECT_LT((integrated.dv(kNoBias, bias) - accel).norm(), 1e-12);
  EXPECT_LT((integrated.dp(kNoBias, bias) - 0.5 * accel).norm(), 1e-12);
}

TEST(Preintegration, FollowsAHelix) {
  const MotionError error = propagation_error(helix(), kMillisecond);
  EXPECT_LT(error.attitude, 1e-12);
  EXPECT_LT(error.velocity, 1e-6);
  EXPECT_LT(error.position, 1e-6);
}

TEST(Preintegration, FollowsATumblingBody) {
  const MotionError error = propagation_error(tumbling(), kMillisecond);
  EXPECT_LT(error.attitude, 3e-6);  // h^2 / 12 times the change of angular acceleration, about 30 rad/s^2
  EXPECT_LT(error.velocity, 2e-5);
  EXPECT_LT(error.position, 1e-5);
}

TEST(Preintegration, HasAnErrorOfSecondOrderInTheSampleInterval) {
  const MotionError coarse = propagation_error(tumbling(), 10 * kMillisecond);
  const MotionError fine = propagation_error(tumbling(), 5 * kMillisecond);
  EXPECT_NEAR(coarse.attitude / fine.attitude, 4.0, 0.2);
  EXPECT_NEAR(coarse.velocity / fine.velocity, 4.0, 0.2);
  EXPECT_NEAR(coarse.position / fine.position, 4.0, 0.2);
}

TEST(Preintegration, HasTheBiasJacobiansOfItsOwnRule) {
  const Vector3d bg(0.02, -0.03, 0.05), ba(0.1, 0.2, -0.1);
  const Preintegration at(tumbling().samples(0.0, 0.5, 5 * kMillisecond), bg, ba, {});
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = kStep * Vector3d::Unit(i);
    const Preintegration g_up = at.reintegrated(bg + d, ba), g_down = at.reintegrated(bg - d, ba);
    const Preintegration a_up = at.reintegrated(bg, ba + d), a_down = at.reintegrated(bg, ba - d);
    const auto close = [](const Vector3d& column, const Vector3d& change) {
      EXPECT_LT((column - change / (2.0 * kStep)).norm(), 1e-8);
    };
    close(at.d_dR_d_bg().col(i), so3::log(g_down.dR(bg - d).conjugate() * g_up.dR(bg + d)));
    close(at.d_dv_d_bg().col(i), g_up.dv(bg + d, ba) - g_down.dv(bg - d, ba));
    close(at.d_dp_d_bg().col(i), g_up.dp(bg + d, ba) - g_down.dp(bg - d, ba));
    close(at.d_dv_d_ba().col(i), a_up.dv(bg, ba + d) - a_down.dv(bg, ba - d));
    close(at.d_dp_d_ba().col(i), a_up.dp(bg, ba + d) - a_down.dp(bg, ba - d));
    EXPECT_LT(so3::log(a_down.dR(bg).conjugate() * a_up.dR(bg)).norm(), 1e-15);
  }
}

TEST(Preintegration, CorrectedToOtherBiasesIsCloseToIntegratingAgain) {
  const Preintegration at(tumbling().samples(0.0, 0.5, 5 * kMillisecond), kNoBias, kNoBias, {});
  const Vector3d bg(0.003, -0.002, 0.004), ba(0.05, -0.03, 0.02);
  const Preintegration again = at.reintegrated(bg, ba);
  const double before = (at.dp(kNoBias, kNoBias) - again.dp(bg, ba)).norm();
  EXPECT_LT((at.dp(bg, ba) - again.dp(bg, ba)).norm(), 1e-3 * before);
  EXPECT_LT((at.dv(bg, ba) - again.dv(bg, ba)).norm(), 1e-4);
  EXPECT_LT(so3::log(at.dR(bg).conjugate() * again.dR(bg)).norm(), 1e-5);
}

TEST(Preintegration, HasTheCovarianceThatNoiseReallyCauses) {
  constexpr int kRuns = 800;
  const Duration interval = 2 * kMillisecond;
  const ImuNoise noise{.gyro_noise = 2e-3, .accel_noise = 2e-2};
  const std::vector<ImuSample> clean = tumbling().samples(0.0, 0.4, interval);
  const Preintegration nominal(clean, kNoBias, kNoBias, noise);
  const double per_sample = 1.0 / std::sqrt(to_seconds(interval));
  std::mt19937_64 generator(7);
  Matrix9d sampled = Matrix9d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    std::vector<ImuSample> noisy = clean;
    for (ImuSample& s : noisy) {
      s.gyro_B += per_sample * noise.gyro_noise * gaussian_vector(generator);
      s.accel_B += per_sample * noise.accel_noise * gaussian_vector(generator);
    }
    const Preintegration drawn(noisy, kNoBias, kNoBias, noise);
    Eigen::Matrix<double, 9, 1> error;
    error << so3::log(nominal.dR(kNoBias).conjugate() * drawn.dR(kNoBias)),
        drawn.dv(kNoBias, kNoBias) - nominal.dv(kNoBias, kNoBias),
        drawn.dp(kNoBias, kNoBias) - nominal.dp(kNoBias, kNoBias);
    sampled += error * error.transpose() / kRuns;
  }
  const Matrix9d& claimed = nominal.covariance();
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(sampled(i, i) / claimed(i, i), 1.0, 0.2) << i;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(claimed(i, i) * claimed(j, j));
      EXPECT_NEAR(sampled(i, j) / scale, claimed(i, j) / scale, 0.15) << i << " " << j;
    }
  }
}

TEST(Preintegration, HasACovarianceThatGrowsWithTimeNotWithTheNumberOfSamples) {
  const ImuNoise noise{.gyro_noise = 2e-3, .accel_noise = 2e-2};
  const Preintegration fine(helix().samples(0.0, 0.5, kMillisecond), kNoBias, kNoBias, noise);
  const Preintegration coarse(helix().samples(0.0, 0.5, 5 * kMillisecond), kNoBias, kNoBias, noise);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(fine.covariance()(i, i) / coarse.covariance()(i, i), 1.0, 0.02);
  EXPECT_NEAR(fine.covariance()(2, 2), 2e-3 * 2e-3 * 0.5, 1e-12);
}

TEST(Preintegration, TrustsSaturatedSamplesLess) {
  const ImuNoise noise{.gyro_saturation = 20.0, .accel_saturation = 100.0, .saturation_inflation = 50.0};
  std::vector<ImuSample> samples = helix().samples(0.0, 0.1, kMillisecond);
  const Preintegration normal(samples, kNoBias, kNoBias, noise);
  EXPECT_TRUE(normal.gyro_trusted());

  samples[50].gyro_B.x() = -20.0;
  const Preintegration gyro(samples, kNoBias, kNoBias, noise);
  EXPECT_TRUE(gyro.gyro_clipped() && !gyro.gyro_trusted());
  // 98 steps as before, the two that touch the sample with 50^2 times the variance.
  EXPECT_NEAR(gyro.covariance()(0, 0) / normal.covariance()(0, 0), (98.0 + 2.0 * 2500.0) / 100.0, 0.5);

  samples[50].gyro_B.x() = 0.0;
  samples[50].accel_B.z() = 157.0;
  const Preintegration accel(samples, kNoBias, kNoBias, noise);
  EXPECT_TRUE(accel.gyro_trusted());
  EXPECT_DOUBLE_EQ(accel.covariance()(0, 0), normal.covariance()(0, 0));
  EXPECT_NEAR(accel.covariance()(5, 5) / normal.covariance()(5, 5), (98.0 + 2.0 * 2500.0) / 100.0, 0.5);
}

TEST(Preintegration, JoinedEqualsIntegratingTheWhole) {
  const ImuNoise noise;
  const std::vector<ImuSample> all = tumbling().samples(0.0, 0.4, 2 * kMillisecond);
  const Vector3d bg(0.01, 0.02, -0.01), ba(0.1, 0.0, -0.2);
  const std::span<const ImuSample> span(all);
  const Preintegration whole(all, bg, ba, noise);
  const Preintegration first(span.first(81), bg, ba, noise);
  const Preintegration second(span.subspan(80), kNoBias, kNoBias, noise);  // its own biases do not matter
  const Preintegration joined = first.joined(second);
  EXPECT_EQ(joined.samples().size(), all.size());
  EXPECT_EQ(joined.begin(), whole.begin());
  EXPECT_EQ(joined.end(), whole.end());
  EXPECT_EQ(joined.dt(), whole.dt());
  EXPECT_EQ(joined.dR(bg).coeffs(), whole.dR(bg).coeffs());
  EXPECT_EQ(joined.dv(bg, ba), whole.dv(bg, ba));
  EXPECT_EQ(joined.dp(bg, ba), whole.dp(bg, ba));
  EXPECT_EQ(joined.d_dp_d_bg(), whole.d_dp_d_bg());
  EXPECT_EQ(joined.covariance(), whole.covariance());
  EXPECT_THROW(second.joined(first), CheckError);
}

TEST(Preintegration, IsNotMovedByStepsOfNoLength) {
  const std::vector<ImuSample> once = tumbling().samples(0.0, 0.1, 2 * kMillisecond);
  std::vector<ImuSample> twice;
  for (const ImuSample& s : once) twice.insert(twice.end(), {s, s});
  const Preintegration a(once, kNoBias, kNoBias, {}), b(twice, kNoBias, kNoBias, {});
  EXPECT_EQ(a.dp(kNoBias, kNoBias), b.dp(kNoBias, kNoBias));
  EXPECT_EQ(a.covariance(), b.covariance());

  const std::vector<ImuSample> instant = {once[3], once[3]};
  const Preintegration still(instant, kNoBias, kNoBias, {});
  EXPECT_EQ(still.dt(), 0.0);
  EXPECT_EQ(still.covariance(), Matrix9d(Matrix9d::Zero()));
  EXPECT_TRUE(still.dR(kNoBias).isApprox(Quaterniond::Identity()));
}

TEST(Preintegration, RefusesSamplesOutOfOrderOrTooFew) {
  std::vector<ImuSample> samples = helix().samples(0.0, 0.01, kMillisecond);
  std::swap(samples[3], samples[4]);
  EXPECT_THROW(Preintegration(samples, kNoBias, kNoBias, {}), CheckError);
  EXPECT_THROW(Preintegration(std::span(samples).first(1), kNoBias, kNoBias, {}), CheckError);
}

TEST(SliceImu, InterpolatesBothEndsAndKeepsWhatLiesBetween) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) {
    samples.push_back({Timestamp(i * 5 * kMillisecond), Vector3d(i, 2.0 * i, -i), Vector3d(0.5 * i, 1.0, -3.0 * i)});
  }
  const auto slice = slice_imu(samples, Timestamp(12 * kMillisecond), Timestamp(29 * kMillisecond));
  ASSERT_EQ(slice.size(), 5u);
  EXPECT_EQ(slice.front().t, Timestamp(12 * kMillisecond));
  EXPECT_TRUE(slice.front().gyro_B.isApprox(Vector3d(2.4, 4.8, -2.4)));
  EXPECT_TRUE(slice.front().accel_B.isApprox(Vector3d(1.2, 1.0, -7.2)));
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(slice[i].t, samples[i + 2].t);
  EXPECT_EQ(slice.back().t, Timestamp(29 * kMillisecond));
  EXPECT_TRUE(slice.back().gyro_B.isApprox(Vector3d(5.8, 11.6, -5.8)));
}

TEST(SliceImu, ThatEndsOnSamplesHasEachOfThemOnce) {
  const std::vector<ImuSample> samples = helix().samples(0.0, 0.05, 5 * kMillisecond);
  const auto slice = slice_imu(samples, samples[2].t, samples[7].t);
  ASSERT_EQ(slice.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(slice[i].t, samples[i + 2].t);
  EXPECT_EQ(slice_imu(samples, samples.front().t, samples.back().t).size(), samples.size());
}

TEST(SliceImu, ErrsBySecondOrderOfTheInterval) {
  const Motion motion = tumbling();
  double bend = 0.0;  // largest second derivative of the rate [rad/s^3]
  for (double t = 0.1; t < 0.91; t += 1e-3) {
    bend = std::max(bend, (motion.rate(t - 1e-3) - 2.0 * motion.rate(t) + motion.rate(t + 1e-3)).norm() * 1e6);
  }
  for (const int ms : {5, 10}) {
    const auto samples = motion.samples(0.0, 1.0, ms * kMillisecond);
    double worst = 0.0;
    for (double t = 0.1; t < 0.9; t += 0.0037) {
      const auto slice = slice_imu(samples, timestamp_from_seconds(t), timestamp_from_seconds(t + 0.01));
      worst = std::max(worst, (slice.front().gyro_B - motion.rate(t)).norm());
    }
    EXPECT_LT(worst, 1.01 * bend * std::pow(ms * 1e-3, 2) / 8.0);
    EXPECT_GT(worst, 0.8 * bend * std::pow(ms * 1e-3, 2) / 8.0);
  }
}

TEST(SliceImu, OfAnInstantHasNoLength) {
  const std::vector<ImuSample> samples = helix().samples(0.0, 0.05, 5 * kMillisecond);
  const auto slice = slice_imu(samples, Timestamp(7 * kMillisecond), Timestamp(7 * kMillisecond));
  ASSERT_EQ(slice.size(), 2u);
  EXPECT_EQ(slice[0].t, slice[1].t);
  EXPECT_EQ(slice_imu(samples, samples[0].t, samples[0].t).size(), 2u);
}

TEST(SliceImu, BridgesAGapBetweenSamples) {
  std::vector<ImuSample> samples;
  for (const int ms : {0, 5, 10, 510, 515}) {
    samples.push_back({Timestamp(ms * kMillisecond), Vector3d(0, 0, 0.5), Vector3d(0, 0, 9.81)});
  }
  const auto slice = slice_imu(samples, Timestamp(100 * kMillisecond), Timestamp(400 * kMillisecond));
  const Preintegration integrated(slice, kNoBias, kNoBias, {});
  EXPECT_NEAR(integrated.dt(), 0.3, 1e-12);
  EXPECT_NEAR(so3::log(integrated.dR(kNoBias)).z(), 0.15, 1e-12);
}

TEST(SliceImu, DoesNotPassOffAsMeasuredWhatItMakesUpInAGap) {
  std::vector<ImuSample> samples;
  for (const int ms : {0, 5, 10, 310, 315, 320}) {
    samples.push_back({Timestamp(ms * kMillisecond), Vector3d(0, 0, 0.5), Vector3d(0, 0, 9.81)});
  }
  const auto bridged = [&](int from_ms, int to_ms) {
    const auto slice = slice_imu(samples, Timestamp(from_ms * kMillisecond), Timestamp(to_ms * kMillisecond));
    return !Preintegration(slice, kNoBias, kNoBias, {}).gyro_trusted();
  };
  EXPECT_FALSE(bridged(2, 10));
  for (int ms = 5; ms < 310; ms += 15) EXPECT_TRUE(bridged(ms, ms + 15)) << ms << " ms";
  EXPECT_FALSE(bridged(310, 318));
}

TEST(SliceImu, RefusesWhatTheSamplesDoNotCover) {
  const std::vector<ImuSample> samples = helix().samples(0.0, 0.05, 5 * kMillisecond);
  EXPECT_THROW(slice_imu(samples, Timestamp(-kMillisecond), Timestamp(kMillisecond)), CheckError);
  EXPECT_THROW(slice_imu(samples, Timestamp(kMillisecond), Timestamp(51 * kMillisecond)), CheckError);
  EXPECT_THROW(slice_imu(samples, Timestamp(2 * kMillisecond), Timestamp(kMillisecond)), CheckError);
  EXPECT_THROW(slice_imu({}, Timestamp(), Timestamp()), CheckError);
}

TEST(PropagateAll, EndsWhereThePreintegrationEnds) {
  const Motion motion = tumbling();
  OdomState start = motion.state(0.3);
  start.bias_gyro = Vector3d(0.01, 0.02, -0.03);
  start.bias_accel = Vector3d(0.1, -0.2, 0.05);
  std::vector<ImuSample> samples = motion.samples(0.3, 0.8, 2 * kMillisecond);
  for (ImuSample& s : samples) s.gyro_B += start.bias_gyro, s.accel_B += start.bias_accel;
  const auto states = propagate_all(start, samples);
  const OdomState end = propagate(start, Preintegration(samples, start.bias_gyro, start.bias_accel, {}));
  ASSERT_EQ(states.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_EQ(states[i].t, samples[i].t);
  EXPECT_LT((states.back().T_O_B.inverse() * end.T_O_B).log().norm(), 1e-12);
  EXPECT_LT((states.back().v_O - end.v_O).norm(), 1e-12);
  EXPECT_EQ(states.back().bias_accel, start.bias_accel);
  EXPECT_LT((states[125].T_O_B.translation() - motion.position(0.55)).norm(), 1e-5);
}

TEST(Propagate, AtRestStaysAtRest) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 100; ++i) samples.push_back({Timestamp(i * 10 * kMillisecond), kNoBias, -kGravity_W});
  const OdomState end =
      propagate({samples[0].t, SE3(), kNoBias, kNoBias, kNoBias}, Preintegration(samples, kNoBias, kNoBias, {}));
  EXPECT_LT(end.T_O_B.translation().norm(), 1e-12);
  EXPECT_LT(end.v_O.norm(), 1e-12);
}

}  // namespace
}  // namespace edged
