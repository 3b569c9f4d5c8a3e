// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/attitude_filter.hpp"

#include <algorithm>

#include "edged/estimator/tuning.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/se3.hpp"

namespace edged {

/// Starts with gravity where the accelerometer has it and the heading zero.
void AttitudeFilter::begin(const ImuSample& sample) {
  R_W_B_ = Eigen::Quaterniond::FromTwoVectors(sample.accel_B, -kGravity_W);
  const double tilt = kAttitudeTuning.first_motion / kGravity_W.norm();
  const Eigen::Matrix3d R = R_W_B_.toRotationMatrix();
  P_.setZero();
  P_.topLeftCorner<3, 3>() = R.transpose() * Eigen::Vector3d(tilt * tilt, tilt * tilt, 0.0).asDiagonal() * R;
  P_.bottomRightCorner<3, 3>().diagonal().setConstant(kAttitudeTuning.gyro_bias_sigma *
                                                      kAttitudeTuning.gyro_bias_sigma);
  motion_variance_ = kAttitudeTuning.first_motion * kAttitudeTuning.first_motion;
}

void AttitudeFilter::propagate(const ImuSample& from, const ImuSample& to) {
  const double dt = to_seconds(to.t - from.t);
  const Eigen::Quaterniond turn = so3::exp((0.5 * (from.gyro_B + to.gyro_B) - bias_) * dt);
  R_W_B_ = (R_W_B_ * turn).normalized();
  Matrix6d F = Matrix6d::Identity();
  F.topLeftCorner<3, 3>() = turn.toRotationMatrix().transpose();
  F.topRightCorner<3, 3>() = -dt * Eigen::Matrix3d::Identity();
  P_ = F * P_ * F.transpose();
  const bool clipped = to.interpolated || gyro_saturated(to, noise_);
  const double noise = noise_.gyro_noise * (clipped ? noise_.saturation_inflation : 1.0);
  P_.topLeftCorner<3, 3>().diagonal().array() += noise * noise * dt;
  P_.bottomRightCorner<3, 3>().diagonal().array() += noise_.gyro_walk * noise_.gyro_walk * dt;
}

/// accel_W: the mean specific force of a packet. Accelerations that last for motion_time_s are as noise whose variance
/// over a span is 2 motion_time_s / span times theirs.
void AttitudeFilter::correct(const Eigen::Vector3d& accel_W, double span_s) {
  const Eigen::Vector3d expected = R_W_B_.conjugate() * -kGravity_W,
                        innovation = R_W_B_.conjugate() * accel_W - expected;
  const double forget = std::min(1.0, span_s / kAttitudeTuning.motion_memory_s);
  motion_variance_ += forget * (innovation.squaredNorm() / 3.0 - motion_variance_);
  motion_variance_ = std::max(motion_variance_, kAttitudeTuning.min_motion * kAttitudeTuning.min_motion);
  Eigen::Matrix<double, 3, 6> H = Eigen::Matrix<double, 3, 6>::Zero();
  H.leftCols<3>() = skew(expected);
  const double variance = motion_variance_ * std::max(1.0, 2.0 * kAttitudeTuning.motion_time_s / span_s);
  const Eigen::Matrix3d S = H * P_ * H.transpose() + variance * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 6, 3> K = P_ * H.transpose() * S.inverse();
  const Eigen::Matrix<double, 6, 1> step = K * innovation;
  R_W_B_ = (R_W_B_ * so3::exp(step.head<3>())).normalized();
  bias_ += step.tail<3>();
  const Matrix6d I_KH = Matrix6d::Identity() - K * H;  // Joseph's form stays symmetric and positive
  P_ = I_KH * P_ * I_KH.transpose() + variance * K * K.transpose();
}

void AttitudeFilter::add(std::span<const ImuSample> imu) {
  if (imu.size() < 2) return;
  if (!attitude_) begin(imu.front());
  Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
  double measured_s = 0.0;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    propagate(imu[i - 1], imu[i]);
    if (imu[i].interpolated) continue;
    const double dt = to_seconds(imu[i].t - imu[i - 1].t);
    sum_W += dt * (R_W_B_ * imu[i].accel_B);
    measured_s += dt;
  }
  if (measured_s > 0.0) correct(sum_W / measured_s, measured_s);
  attitude_ = {R_W_B_, P_.topLeftCorner<3, 3>()};
}

}  // namespace edged
