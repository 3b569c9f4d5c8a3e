// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// IMU preintegration between two instants (Forster et al., "On-Manifold Preintegration", T-RO 2017), and propagation.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"

namespace edged {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// Two samples farther apart than this have little information on the motion between them.
inline constexpr Duration kMaxSampleInterval = std::chrono::milliseconds(30);

/// Whether the step between two samples lies in a gap of the recording, wholly or in part.
bool in_gap(const ImuSample& a, const ImuSample& b);

/// Whether a reading is at or beyond the sensor's range: by the calibration, or by the gate (ImuSample).
bool gyro_saturated(const ImuSample& sample, const ImuNoise& noise);
bool accel_saturated(const ImuSample& sample, const ImuNoise& noise);

/// Samples from t_0 to t_1 inclusive, both ends interpolated linearly from their neighbours, and marked as interpolated
/// if that is across a gap. `samples` are in time order and must cover [t_0, t_1] (CheckError otherwise).
std::vector<ImuSample> slice_imu(std::span<const ImuSample> samples, Timestamp t_0, Timestamp t_1);

/// The motion between the first and the last sample, free of the state it starts from:
/// R_1 = R_0 dR, v_1 = v_0 + g dt + R_0 dv, p_1 = p_0 + v_0 dt + g dt^2 / 2 + R_0 dp.
/// Midpoint rule per interval. Error state order: (d_phi, d_v, d_p), right perturbation of dR.
class Preintegration {
 public:
  Preintegration() = default;
  /// samples: two or more, in time order, as slice_imu gives them; biases are subtracted before integrating.
  Preintegration(std::span<const ImuSample> samples, const Eigen::Vector3d& bias_gyro,
                 const Eigen::Vector3d& bias_accel, const ImuNoise& noise);

  /// Integrates again around new biases (when they have moved too far for the first-order correction).
  Preintegration reintegrated(const Eigen::Vector3d& bias_gyro, const Eigen::Vector3d& bias_accel) const;

  /// This interval and the one that follows it, as one (keeps the biases of this one).
  Preintegration joined(const Preintegration& next) const;

  /// Without its samples, which are most of it: it cannot be integrated again nor joined then, and has no begin or end.
  Preintegration without_samples() const;

  double dt() const { return dt_; }  ///< [s]
  Timestamp begin() const { return samples_.front().t; }
  Timestamp end() const { return samples_.back().t; }
  const std::vector<ImuSample>& samples() const { return samples_; }
  const Eigen::Vector3d& bias_gyro() const { return bias_gyro_; }
  const Eigen::Vector3d& bias_accel() const { return bias_accel_; }

  /// Mean readings over the interval, less the biases that it was integrated with.
  Eigen::Vector3d mean_gyro() const { return sum_gyro_ / std::max(dt_, 1e-9) - bias_gyro_; }
  Eigen::Vector3d mean_accel() const { return sum_accel_ / std::max(dt_, 1e-9) - bias_accel_; }

  /// The deltas corrected to first order for other biases.
  Eigen::Quaterniond dR(const Eigen::Vector3d& bias_gyro) const;
  Eigen::Vector3d dv(const Eigen::Vector3d& bias_gyro, const Eigen::Vector3d& bias_accel) const;
  Eigen::Vector3d dp(const Eigen::Vector3d& bias_gyro, const Eigen::Vector3d& bias_accel) const;

  const Eigen::Matrix3d& d_dR_d_bg() const { return d_dR_d_bg_; }  ///< d Log(dR) / d bias_gyro, right
  const Eigen::Matrix3d& d_dv_d_bg() const { return d_dv_d_bg_; }
  const Eigen::Matrix3d& d_dv_d_ba() const { return d_dv_d_ba_; }
  const Eigen::Matrix3d& d_dp_d_bg() const { return d_dp_d_bg_; }
  const Eigen::Matrix3d& d_dp_d_ba() const { return d_dp_d_ba_; }

  const Matrix9d& covariance() const { return covariance_; }  ///< covariance of (d_phi, d_v, d_p) by the white noise
  const ImuNoise& noise() const { return noise_; }
  /// Whether some sample reached the gyro's range: the rotation is known from the cameras alone.
  bool gyro_clipped() const { return gyro_clipped_; }
  /// Whether no sample was clipped or missing (kMaxSampleInterval).
  bool gyro_trusted() const { return !gyro_clipped_ && gap_s_ == 0.0; }
  /// Duration without samples [s].
  double gap_s() const { return gap_s_; }

 private:
  void integrate_step(const ImuSample& a, const ImuSample& b);

  std::vector<ImuSample> samples_;
  ImuNoise noise_;
  Eigen::Vector3d bias_gyro_ = Eigen::Vector3d::Zero(), bias_accel_ = Eigen::Vector3d::Zero();
  double dt_ = 0.0;
  Eigen::Vector3d sum_gyro_ = Eigen::Vector3d::Zero(), sum_accel_ = Eigen::Vector3d::Zero();  // times the time
  Eigen::Quaterniond dR_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d dv_ = Eigen::Vector3d::Zero(), dp_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d d_dR_d_bg_ = Eigen::Matrix3d::Zero(), d_dv_d_bg_ = Eigen::Matrix3d::Zero(),
                  d_dv_d_ba_ = Eigen::Matrix3d::Zero(), d_dp_d_bg_ = Eigen::Matrix3d::Zero(),
                  d_dp_d_ba_ = Eigen::Matrix3d::Zero();
  Matrix9d covariance_ = Matrix9d::Zero();
  bool gyro_clipped_ = false;
  double gap_s_ = 0.0;
};

/// The state at the last sample, from the state at the first. Biases are unchanged.
OdomState propagate(const OdomState& start, const Preintegration& motion);

/// The states at every sample, the first being `start`: the poses that the warp interpolates between.
std::vector<OdomState> propagate_all(const OdomState& start, std::span<const ImuSample> samples);

}  // namespace edged
