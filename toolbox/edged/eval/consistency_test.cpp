// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/consistency.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "edged/eval/test_trajectories.hpp"

namespace edged {
namespace {

const SE3 kGauge(so3::exp({0.0, 0.0, 0.8}), Eigen::Vector3d(3.0, -2.0, 1.0));

Eigen::Matrix3d covariance(const Eigen::Vector3d& sigmas, const Eigen::Vector3d& turn) {
  const Eigen::Matrix3d R = so3::exp(turn).toRotationMatrix();
  return R * sigmas.cwiseAbs2().asDiagonal() * R.transpose();
}
const Eigen::Matrix3d kPosition = covariance({0.01, 0.02, 0.05}, {0.3, -0.2, 0.5});
const Eigen::Matrix3d kVelocity = covariance({0.02, 0.05, 0.1}, {0.5, 0.1, -0.3});
const Eigen::Matrix3d kRotation = covariance({0.002, 0.004, 0.01}, {-0.1, 0.4, 0.2});

void make_exact(StateCovarianceSample& sample, const SE3& T_W_B) {
  sample.T_W_B = T_W_B;
  sample.covariance.position = sample.covariance.rotation = Eigen::Matrix3d::Zero();
}

/// Poses that are off by normal errors of these covariances times `factor`, in another world; the first is exact.
std::vector<StateCovarianceSample> covariance_samples_of(const Trajectory& truth, double factor = 1.0,
                                                         const SE3& T_W_Wtrue = kGauge) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  const auto draw = [&](const Eigen::Matrix3d& P) {
    const Eigen::Vector3d white(normal(engine), normal(engine), normal(engine));
    return Eigen::Vector3d(P.llt().matrixL() * (factor * white));
  };
  const Eigen::Matrix3d R = T_W_Wtrue.R();
  std::vector<StateCovarianceSample> samples;
  for (const StampedPose& pose : truth) {
    const Eigen::Vector3d p = pose.T.translation() - draw(kPosition);
    const Eigen::Quaterniond q = pose.T.rotation() * so3::exp(-draw(kRotation));
    const StateCovariance P{R * kPosition * R.transpose(), kRotation, R * kVelocity * R.transpose()};
    samples.push_back({pose.t, T_W_Wtrue * SE3(q, p), R * winding_velocity(pose.t), P});
  }
  for (StateCovarianceSample& sample : samples) sample.v_W -= R * draw(kVelocity);
  make_exact(samples.front(), T_W_Wtrue * truth.front().T);
  return samples;
}

TEST(Consistency, NormalErrorsOfTheClaimedSizeHaveTheMeansAndSharesOfChiSquare) {
  const Trajectory truth = winding_motion(200.0);
  const Consistency found = check_consistency(truth, covariance_samples_of(truth));
  EXPECT_EQ(found.poses, truth.size());
  EXPECT_EQ(found.references, 1U);
  for (const NormalizedErrors& errors : {found.position, found.rotation, found.velocity}) {
    EXPECT_NEAR(errors.mean_nees, 3.0, 0.1);  // sqrt(6 / 10000) = 0.025 by chance
    EXPECT_GT(errors.max_nees, 16.0);
    EXPECT_LT(errors.max_nees, 30.0);
    EXPECT_NEAR(errors.within, 0.9973, 0.002);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(errors.axes_within[i], 0.9973, 0.002);
  }
  EXPECT_TRUE(found.silent.empty());
}

TEST(Consistency, ErrorsTwiceAsLargeAsClaimedAreFourTimesTheMean) {
  const Trajectory truth = winding_motion(200.0);
  const Consistency found = check_consistency(truth, covariance_samples_of(truth, 2.0));
  EXPECT_NEAR(found.position.mean_nees, 12.0, 0.4);
  EXPECT_NEAR(found.rotation.mean_nees, 12.0, 0.4);
  EXPECT_LT(found.position.within, 0.75);
  EXPECT_LT(found.position.axes_within.maxCoeff(), 0.9);
}

TEST(Consistency, MeansAroundSomeInstantsOfTheFirstStart) {
  const Trajectory truth = winding_motion(30.0);
  std::vector<StateCovarianceSample> samples = covariance_samples_of(truth);
  Consistency found = check_consistency(truth, samples);
  ASSERT_EQ(found.at.size(), 2U);  // 5 and 20 s
  for (const NeesAt& at : found.at) {
    for (const double nees : {at.position, at.rotation, at.velocity}) EXPECT_NEAR(nees, 3.0, 1.6);  // of 25 poses
  }
  for (StateCovarianceSample& sample : samples) {
    sample.reference = sample.t > timestamp_from_seconds(110.0) ? 1 : 0;
    sample.covariance.velocity.setZero();
  }
  found = check_consistency(truth, samples);
  ASSERT_EQ(found.at.size(), 1U);
  EXPECT_EQ(found.at[0].since_start_s, 5.0);
  EXPECT_TRUE(std::isnan(found.at[0].velocity));
  EXPECT_EQ(found.velocity.mean_nees, 0.0);
}

TEST(Consistency, EveryErrorComesWithItsSizeAsClaimed) {
  const Trajectory truth = winding_motion(200.0);
  const Consistency found = check_consistency(truth, covariance_samples_of(truth));
  ASSERT_EQ(found.errors.size(), truth.size());
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (const PoseErrorSample& e : found.errors) squares += e.error.array().square();
  const Eigen::Array3d spread = (squares / static_cast<double>(truth.size())).sqrt();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.errors.back().sigma[i], std::sqrt(kPosition(i, i)), 1e-9);
    EXPECT_NEAR(spread[i], std::sqrt(kPosition(i, i)), 0.03 * spread[i]);
  }
}

/// Poses from from_s to to_s after the first, moved by d in the world.
std::vector<StateCovarianceSample> shifted(std::vector<StateCovarianceSample> samples, double from_s, double to_s,
                                           const Eigen::Vector3d& d) {
  const Timestamp first = samples.front().t;
  for (StateCovarianceSample& sample : samples)
    if (const double s = to_seconds(sample.t - first); s >= from_s && s < to_s) sample.T_W_B.translation() += d;
  return samples;
}

TEST(Consistency, GoodPosesBeyondTheirBoundsForHalfASecondAreASilentDivergence) {
  const Trajectory truth = winding_motion(20.0);
  const std::vector<StateCovarianceSample> samples = covariance_samples_of(truth);
  const Eigen::Vector3d far(0.5, 0.5, 0.5);
  EXPECT_TRUE(check_consistency(truth, shifted(samples, 5.0, 5.45, far)).silent.empty());
  const Consistency found = check_consistency(truth, shifted(samples, 5.0, 8.0, far));
  ASSERT_EQ(found.silent.size(), 1U);
  EXPECT_NEAR(to_seconds(found.silent[0].begin), 105.0, 0.021);
  EXPECT_NEAR(found.silent_s(), 3.0, 0.041);
}

TEST(Consistency, ThreeSigmaAreThoseOfEachAxis) {
  const Trajectory truth = winding_motion(20.0);
  const std::vector<StateCovarianceSample> exact = covariance_samples_of(truth, 0.0, SE3());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d sigma = std::sqrt(kPosition(axis, axis)) * Eigen::Vector3d::Unit(axis);
    EXPECT_EQ(check_consistency(truth, shifted(exact, 5.0, 8.0, 2.95 * sigma)).silent.size(), 0U) << axis;
    EXPECT_EQ(check_consistency(truth, shifted(exact, 5.0, 8.0, 3.05 * sigma)).silent.size(), 1U) << axis;
  }
}

TEST(Consistency, PosesThatAreNotCalledGoodDivergeButNotSilently) {
  const Trajectory truth = winding_motion(20.0);
  std::vector<StateCovarianceSample> samples = shifted(covariance_samples_of(truth), 5.0, 8.0, {0.5, 0.5, 0.5});
  for (StateCovarianceSample& sample : samples) sample.good = sample.t < timestamp_from_seconds(105.0);
  const Consistency found = check_consistency(truth, samples);
  EXPECT_TRUE(found.silent.empty());
  EXPECT_NEAR(found.position.within, 1.0 - 3.0 / 20.0, 0.01);
}

TEST(Consistency, EveryReferenceIsAlignedWithTheTruthAnew) {
  const Trajectory truth = winding_motion(20.0);
  std::vector<StateCovarianceSample> samples = covariance_samples_of(truth);
  const SE3 jump(so3::exp({0.0, 0.0, -0.5}), Eigen::Vector3d(1.0, 0.0, 0.0));
  const std::size_t half = samples.size() / 2;
  make_exact(samples[half], kGauge * truth[half].T);
  for (std::size_t i = half; i < samples.size(); ++i) {
    samples[i].T_W_B = jump * samples[i].T_W_B;
    samples[i].covariance.position = jump.R() * samples[i].covariance.position * jump.R().transpose();
  }
  EXPECT_GT(check_consistency(truth, samples).silent_s(), 9.0);
  for (std::size_t i = half; i < samples.size(); ++i) samples[i].reference = 1;
  const Consistency found = check_consistency(truth, samples);
  EXPECT_EQ(found.references, 2U);
  EXPECT_TRUE(found.silent.empty());
  EXPECT_NEAR(found.position.mean_nees, 3.0, 0.3);
}

TEST(Consistency, AFirstPoseThatIsOffByWhatItClaimsCondemnsNoOther) {
  const Trajectory truth = winding_motion(20.0);
  std::vector<StateCovarianceSample> samples;
  const Eigen::Matrix3d small = 1e-8 * Eigen::Matrix3d::Identity();
  for (const StampedPose& pose : truth)
    samples.push_back({pose.t, kGauge * pose.T, Eigen::Vector3d::Zero(), {small, small, Eigen::Matrix3d::Zero()}});
  // Two centimetres and a degree of yaw off, with a covariance to match.
  samples.front().T_W_B = SE3(so3::exp({0.0, 0.0, 0.017}), Eigen::Vector3d(0.02, -0.01, 0.01)) * samples.front().T_W_B;
  EXPECT_LT(check_consistency(truth, samples).position.within, 0.01);
  samples.front().covariance.position = 4e-4 * Eigen::Matrix3d::Identity();
  samples.front().covariance.rotation = 3e-4 * Eigen::Matrix3d::Identity();
  const Consistency found = check_consistency(truth, samples);
  EXPECT_EQ(found.position.within, 1.0);
  EXPECT_EQ(found.rotation.within, 1.0);
}

TEST(Consistency, WhatIsNotYetGoodAtAStartIsLeftOut) {
  const Trajectory truth = winding_motion(20.0);
  std::vector<StateCovarianceSample> samples = covariance_samples_of(truth);
  for (std::size_t i = 0; i < 100; ++i) samples[i].good = false;
  make_exact(samples[100], kGauge * truth[100].T);
  EXPECT_EQ(check_consistency(truth, samples).poses, samples.size() - 100);
  for (StateCovarianceSample& sample : samples) sample.good = false;
  EXPECT_EQ(check_consistency(truth, samples).poses, 0U);
}

}  // namespace
}  // namespace edged
