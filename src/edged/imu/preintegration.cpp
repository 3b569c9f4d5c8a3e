// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu/preintegration.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/imu/tuning.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

ImuSample interpolate_samples(const ImuSample& a, const ImuSample& b, Timestamp t) {
  const double span = to_seconds(b.t - a.t);
  const double share = span > 0.0 ? to_seconds(t - a.t) / span : 0.0;
  return {t,
          a.gyro_B + share * (b.gyro_B - a.gyro_B),
          a.accel_B + share * (b.accel_B - a.accel_B),
          in_gap(a, b),
          a.gyro_clipped || b.gyro_clipped,
          a.accel_clipped || b.accel_clipped};
}

/// samples cover t.
ImuSample sample_at(std::span<const ImuSample> samples, Timestamp t) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), t,
                                      [](const ImuSample& s, Timestamp value) { return s.t < value; });
  return after->t == t ? *after : interpolate_samples(*(after - 1), *after, t);
}

/// Between two samples far apart the signal does not follow the integrated straight line: the vibration after a knock
/// is faster than the sample rate. Standard deviation of the mean over the step; 0 for the jumps of a body in flight.
double sigma_of_jump(const Vector3d& a, const Vector3d& b, double usual) {
  return kImuTuning.jump_share * std::max(0.0, (b - a).norm() - usual);
}

double density(double noise, bool gap, double gap_noise, bool clipped, double inflation) {
  return gap ? std::max(noise, gap_noise) : noise * (clipped ? inflation : 1.0);
}

/// One step linearised: errors at its start and of its two measurements to errors at its end.
struct StepJacobians {
  double dt = 0.0;        // [s]
  Matrix3d turn_back;     // d phi / d phi at the start
  Matrix3d d_phi_d_gyro;  // [s]
  Matrix3d d_v_d_phi, d_v_d_gyro, d_v_d_accel;
};

/// A * M, where A takes errors (phi, v, p) from the start of the step to its end, without the zeros and ones of A:
/// position follows from velocity, dp = dt v + dt/2 dv, so its rows are dt/2 times those that velocity gains.
Matrix9d advance_errors(const StepJacobians& step, const Matrix9d& M) {
  const Eigen::Matrix<double, 3, 9> v_gain = step.d_v_d_phi * M.topRows<3>();
  Matrix9d next;
  next.topRows<3>() = step.turn_back * M.topRows<3>();
  next.middleRows<3>(3) = M.middleRows<3>(3) + v_gain;
  next.bottomRows<3>() = M.bottomRows<3>() + step.dt * M.middleRows<3>(3) + 0.5 * step.dt * v_gain;
  return next;
}

/// (I5). Variances are those of the mean rate and acceleration of the step, per axis.
Matrix9d next_covariance(const Matrix9d& covariance, const StepJacobians& step, double gyro_variance,
                         double accel_variance) {
  const double half_dt = 0.5 * step.dt;
  Eigen::Matrix<double, 9, 3> G_gyro, G_accel;
  G_gyro << step.d_phi_d_gyro, step.d_v_d_gyro, half_dt * step.d_v_d_gyro;
  G_accel << Matrix3d::Zero(), step.d_v_d_accel, half_dt * step.d_v_d_accel;
  // A (A P)^T = A P A^T, as P is symmetric.
  Matrix9d next = advance_errors(step, advance_errors(step, covariance).transpose());
  next += (gyro_variance * G_gyro) * G_gyro.transpose() + (accel_variance * G_accel) * G_accel.transpose();
  return next;
}

}  // namespace

bool in_gap(const ImuSample& a, const ImuSample& b) {
  return a.interpolated || b.interpolated || b.t - a.t > kMaxSampleInterval;
}

bool gyro_saturated(const ImuSample& sample, const ImuNoise& noise) {
  return sample.gyro_clipped || sample.gyro_B.cwiseAbs().maxCoeff() >= noise.gyro_saturation;
}

bool accel_saturated(const ImuSample& sample, const ImuNoise& noise) {
  return sample.accel_clipped || sample.accel_B.cwiseAbs().maxCoeff() >= noise.accel_saturation;
}

std::vector<ImuSample> slice_imu(std::span<const ImuSample> samples, Timestamp t_0, Timestamp t_1) {
  EDGED_CHECK(t_0 <= t_1, "slice from {} to {} ns", to_ns(t_0), to_ns(t_1));
  EDGED_CHECK(!samples.empty() && samples.front().t <= t_0 && t_1 <= samples.back().t,
              "{} samples do not cover {} to {} ns", samples.size(), to_ns(t_0), to_ns(t_1));
  const auto first = std::upper_bound(samples.begin(), samples.end(), t_0,
                                      [](Timestamp value, const ImuSample& s) { return value < s.t; });
  const auto last =
      std::lower_bound(first, samples.end(), t_1, [](const ImuSample& s, Timestamp value) { return s.t < value; });
  std::vector<ImuSample> slice;
  slice.reserve(static_cast<std::size_t>(last - first) + 2);
  slice.push_back(sample_at(samples, t_0));
  slice.insert(slice.end(), first, last);
  slice.push_back(sample_at(samples, t_1));
  return slice;
}

Preintegration::Preintegration(std::span<const ImuSample> samples, const Vector3d& bias_gyro,
                               const Vector3d& bias_accel, const ImuNoise& noise)
    : samples_(samples.begin(), samples.end()), noise_(noise), bias_gyro_(bias_gyro), bias_accel_(bias_accel) {
  EDGED_CHECK(samples_.size() >= 2, "{} samples", samples_.size());
  for (std::size_t i = 1; i < samples_.size(); ++i) integrate_step(samples_[i - 1], samples_[i]);
}

void Preintegration::integrate_step(const ImuSample& a, const ImuSample& b) {
  EDGED_CHECK(a.t <= b.t, "samples out of order: {} before {} ns", to_ns(a.t), to_ns(b.t));
  if (a.t == b.t) return;
  const double dt = to_seconds(b.t - a.t);
  const Vector3d phi = (0.5 * (a.gyro_B + b.gyro_B) - bias_gyro_) * dt;
  const Vector3d accel_a = a.accel_B - bias_accel_, accel_b = b.accel_B - bias_accel_;
  const Quaterniond turn = so3::exp(phi);
  const Quaterniond dR_next = (dR_ * turn).normalized();
  const Matrix3d R_a = dR_.toRotationMatrix(), R_b = dR_next.toRotationMatrix();

  // (I2) - (I4)
  const Vector3d dv_step = 0.5 * dt * (R_a * accel_a + R_b * accel_b);
  dp_ += dt * dv_ + 0.5 * dt * dv_step;
  dv_ += dv_step;
  dR_ = dR_next;
  dt_ += dt;
  sum_gyro_ += 0.5 * dt * (a.gyro_B + b.gyro_B);
  sum_accel_ += 0.5 * dt * (a.accel_B + b.accel_B);

  StepJacobians step;
  step.dt = dt;
  step.turn_back = turn.toRotationMatrix().transpose();
  step.d_phi_d_gyro = so3::right_jacobian(phi) * dt;
  const Matrix3d d_v_d_phi_b = -0.5 * dt * R_b * skew(accel_b);
  step.d_v_d_phi = -0.5 * dt * R_a * skew(accel_a) + d_v_d_phi_b * step.turn_back;
  step.d_v_d_gyro = d_v_d_phi_b * step.d_phi_d_gyro;
  step.d_v_d_accel = 0.5 * dt * (R_a + R_b);

  // (I6): a bias error is a measurement error of the opposite sign.
  const Matrix3d dv_step_d_bg = step.d_v_d_phi * d_dR_d_bg_ - step.d_v_d_gyro;
  d_dp_d_bg_ += dt * d_dv_d_bg_ + 0.5 * dt * dv_step_d_bg;
  d_dp_d_ba_ += dt * d_dv_d_ba_ - 0.5 * dt * step.d_v_d_accel;
  d_dv_d_bg_ += dv_step_d_bg;
  d_dv_d_ba_ -= step.d_v_d_accel;
  d_dR_d_bg_ = step.turn_back * d_dR_d_bg_ - step.d_phi_d_gyro;

  const bool gap = in_gap(a, b);
  const bool gyro_clipped = gyro_saturated(a, noise_) || gyro_saturated(b, noise_);
  const bool accel_clipped = accel_saturated(a, noise_) || accel_saturated(b, noise_);
  const double inflation = noise_.saturation_inflation;
  const double gyro_sigma = density(noise_.gyro_noise, gap, kImuTuning.gap_gyro_noise, gyro_clipped, inflation);
  const double accel_sigma = density(noise_.accel_noise, gap, kImuTuning.gap_accel_noise, accel_clipped, inflation);
  gyro_clipped_ = gyro_clipped_ || gyro_clipped;
  if (gap) gap_s_ += dt;
  const double gyro_jump = gap || gyro_clipped ? 0.0 : sigma_of_jump(a.gyro_B, b.gyro_B, kImuTuning.usual_gyro_jump);
  const double accel_jump =
      gap || accel_clipped ? 0.0 : sigma_of_jump(a.accel_B, b.accel_B, kImuTuning.usual_accel_jump);
  covariance_ = next_covariance(covariance_, step, gyro_sigma * gyro_sigma / dt + gyro_jump * gyro_jump,
                                accel_sigma * accel_sigma / dt + accel_jump * accel_jump);
}

Preintegration Preintegration::reintegrated(const Vector3d& bias_gyro, const Vector3d& bias_accel) const {
  return {samples_, bias_gyro, bias_accel, noise_};
}

Preintegration Preintegration::joined(const Preintegration& next) const {
  EDGED_CHECK(end() == next.begin(), "first ends at {}, second begins at {} ns", to_ns(end()), to_ns(next.begin()));
  Preintegration both = *this;
  both.noise_.gyro_noise = std::max(noise_.gyro_noise, next.noise_.gyro_noise);
  both.noise_.accel_noise = std::max(noise_.accel_noise, next.noise_.accel_noise);
  both.samples_.reserve(samples_.size() + next.samples_.size() - 1);
  for (std::size_t i = 1; i < next.samples_.size(); ++i) {
    both.integrate_step(next.samples_[i - 1], next.samples_[i]);
    both.samples_.push_back(next.samples_[i]);
  }
  return both;
}

Preintegration Preintegration::without_samples() const {
  Preintegration motion = *this;
  motion.samples_ = {};
  return motion;
}

Quaterniond Preintegration::dR(const Vector3d& bias_gyro) const {
  return dR_ * so3::exp(d_dR_d_bg_ * (bias_gyro - bias_gyro_));
}

Vector3d Preintegration::dv(const Vector3d& bias_gyro, const Vector3d& bias_accel) const {
  return dv_ + d_dv_d_bg_ * (bias_gyro - bias_gyro_) + d_dv_d_ba_ * (bias_accel - bias_accel_);
}

Vector3d Preintegration::dp(const Vector3d& bias_gyro, const Vector3d& bias_accel) const {
  return dp_ + d_dp_d_bg_ * (bias_gyro - bias_gyro_) + d_dp_d_ba_ * (bias_accel - bias_accel_);
}

OdomState propagate(const OdomState& start, const Preintegration& motion) {
  const double dt = motion.dt();
  const Quaterniond& R_0 = start.T_O_B.rotation();
  const Vector3d& p_0 = start.T_O_B.translation();
  OdomState next = start;
  next.t = motion.end();
  next.T_O_B = {R_0 * motion.dR(start.bias_gyro),
                p_0 + start.v_O * dt + 0.5 * dt * dt * kGravity_W + R_0 * motion.dp(start.bias_gyro, start.bias_accel)};
  next.v_O = start.v_O + dt * kGravity_W + R_0 * motion.dv(start.bias_gyro, start.bias_accel);
  return next;
}

std::vector<OdomState> propagate_all(const OdomState& start, std::span<const ImuSample> samples) {
  EDGED_CHECK(!samples.empty(), "no samples to propagate over");
  std::vector<OdomState> states;
  states.reserve(samples.size());
  states.push_back(start);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ImuSample &a = samples[i - 1], &b = samples[i];
    EDGED_CHECK(a.t <= b.t, "samples out of order: {} before {} ns", to_ns(a.t), to_ns(b.t));
    const double dt = to_seconds(b.t - a.t);
    const OdomState& from = states.back();
    const Quaterniond& R_a = from.T_O_B.rotation();
    // (I2) - (I4) with the state as the starting point: the same rule as the preintegration, to the last digits.
    const Quaterniond R_b = R_a * so3::exp((0.5 * (a.gyro_B + b.gyro_B) - start.bias_gyro) * dt);
    const Vector3d accel_O =
        0.5 * (R_a * (a.accel_B - start.bias_accel) + R_b * (b.accel_B - start.bias_accel)) + kGravity_W;
    OdomState next = from;
    next.t = b.t;
    next.v_O += dt * accel_O;
    next.T_O_B = {R_b, from.T_O_B.translation() + 0.5 * dt * (from.v_O + next.v_O)};
    states.push_back(next);
  }
  return states;
}

}  // namespace edged
