// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/attitude_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "edged/core/angles.hpp"
#include "edged/se3.hpp"

namespace edged {
namespace {

const Eigen::Vector3d kTrueGyroBias(0.02, -0.03, 0.04);

/// Samples of a body that turns and, if it sways, accelerates by 1.5 m/s^2, with its true attitude.
class TurningBody {
 public:
  explicit TurningBody(double sway) : sway_(sway) {}

  /// The packet of the next 30 ms.
  std::vector<ImuSample> packet() {
    std::vector<ImuSample> samples = {sample()};
    for (int i = 0; i < 30; ++i) {
      const double t = to_seconds(t_ - Timestamp());
      R_W_B_ = R_W_B_ * so3::exp(rate(t + 0.5e-3) * 1e-3);
      t_ += std::chrono::milliseconds(1);
      samples.push_back(sample());
    }
    return samples;
  }
  const Eigen::Quaterniond& R_W_B() const { return R_W_B_; }

 private:
  static Eigen::Vector3d rate(double t) { return {0.5 * std::sin(0.7 * t), 0.3 * std::cos(1.1 * t), 0.6}; }
  ImuSample sample() {
    const double t = to_seconds(t_ - Timestamp());
    const Eigen::Vector3d a_W = sway_ * Eigen::Vector3d(std::sin(5.0 * t), std::cos(4.0 * t), std::sin(6.0 * t));
    const auto noise = [&] { return Eigen::Vector3d(normal_(random_), normal_(random_), normal_(random_)); };
    return {t_, rate(t) + kTrueGyroBias + 0.03 * noise(), R_W_B_.conjugate() * (a_W - kGravity_W) + 0.3 * noise()};
  }

  double sway_;
  Timestamp t_ = timestamp_from_seconds(0.0);
  Eigen::Quaterniond R_W_B_ = so3::exp({0.4, -0.3, 0.0});
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

/// Error of roll and pitch: the angle between the true and the estimated vertical.
double tilt_error_deg(const Eigen::Quaterniond& truth, const Eigen::Quaterniond& estimate) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  return kDegreesPerRadian * std::acos(std::clamp((truth.conjugate() * up).dot(estimate.conjugate() * up), -1.0, 1.0));
}

double tilt_sigma_deg(const Attitude& attitude) {
  const Eigen::Matrix3d R = attitude.R_W_B.toRotationMatrix(), P_W = R * attitude.covariance * R.transpose();
  return kDegreesPerRadian * std::sqrt(P_W.topLeftCorner<2, 2>().trace());
}

/// Returns the share of packets, after 2 s of 20 s, whose error is within three sigma, and the last error and sigma.
struct FilterRun {
  double within = 0.0, last_error_deg = 0.0, last_sigma_deg = 0.0, bias_error = 0.0;
};
FilterRun filter_of(TurningBody body) {
  AttitudeFilter filter{ImuNoise{}};
  FilterRun run;
  int judged = 0, within = 0;
  for (int i = 0; i < 667; ++i) {
    filter.add(body.packet());
    run.last_error_deg = tilt_error_deg(body.R_W_B(), filter.attitude()->R_W_B);
    run.last_sigma_deg = tilt_sigma_deg(*filter.attitude());
    if (i < 67) continue;
    ++judged;
    within += run.last_error_deg < 3.0 * run.last_sigma_deg ? 1 : 0;
  }
  run.within = static_cast<double>(within) / judged;
  run.bias_error = (filter.gyro_bias() - kTrueGyroBias).norm();
  return run;
}

TEST(AttitudeFilter, KnowsTheTiltOfABodyThatTurnsInPlace) {
  const FilterRun run = filter_of(TurningBody(0.0));
  EXPECT_LT(run.last_error_deg, 0.2);
  EXPECT_LT(run.last_sigma_deg, 0.5);
  EXPECT_GT(run.within, 0.99);
  EXPECT_LT(run.bias_error, 0.01);
}

TEST(AttitudeFilter, AccelerationsMakeItLessCertainAndAreCovered) {
  const FilterRun run = filter_of(TurningBody(1.5));
  EXPECT_LT(run.last_error_deg, 2.0);
  EXPECT_GT(run.last_sigma_deg, 0.3);
  EXPECT_GT(run.within, 0.99);
}

TEST(AttitudeFilter, AGapMakesItUncertain) {
  TurningBody body(0.0);
  AttitudeFilter filter{ImuNoise{}};
  for (int i = 0; i < 200; ++i) filter.add(body.packet());
  const double before_deg = tilt_sigma_deg(*filter.attitude());
  std::vector<ImuSample> gap = body.packet();
  for (ImuSample& sample : gap) sample.interpolated = true;
  filter.add(gap);
  EXPECT_GT(tilt_sigma_deg(*filter.attitude()), 5.0 * before_deg);
}

TEST(AttitudeFilter, KnowsNothingBeforeTheFirstPacket) { EXPECT_FALSE(AttitudeFilter{ImuNoise{}}.attitude()); }

}  // namespace
}  // namespace edged
