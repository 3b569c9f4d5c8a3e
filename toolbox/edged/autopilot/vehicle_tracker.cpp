// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/vehicle_tracker.hpp"

#include <algorithm>
#include <limits>

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// A correction of the map that moves the body farther is a jump. Smaller ones stay within the noise that EKF2 assumes
/// by default (0.1 m, 0.1 rad): a reset costs it more than an innovation.
constexpr double kJump_m = 0.1, kJump_rad = 0.05;

/// From W, z up, to the world of the autopilot, z down: half a turn about x.
const Quaterniond kFlip(0.0, 1.0, 0.0, 0.0);

template <int N>
std::array<float, N> floats(const Eigen::Matrix<double, N, 1>& v) {
  std::array<float, N> array;
  for (int i = 0; i < N; ++i) array[static_cast<std::size_t>(i)] = static_cast<float>(v[i]);
  return array;
}

std::uint64_t microseconds(Timestamp t) {
  const Duration since = t.time_since_epoch();
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, since / std::chrono::microseconds(1)));
}

/// Standard deviations along rotated axes.
Vector3d sigmas(const Matrix3d& R, const Matrix3d& covariance) {
  return (R * covariance * R.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
}

std::int8_t quality_of(const Step& step) {
  constexpr std::size_t kMost = 50;
  const auto landmarks = std::clamp<std::size_t>(step.landmarks.size(), 1, kMost);
  return static_cast<std::int8_t>(landmarks + (step.status == TrackingStatus::Good ? kMost : 0));
}

}  // namespace

bool VehicleTracker::jumps(const Step& step) const {
  if (!newest_) return false;
  if (!step.started.empty() || step.relocalized) return true;
  const SE3& T_W_B = step.state.T_W_B;
  const SE3 before = newest_->T_M_O * step.T_M_O.inverse() * T_W_B;
  return (T_W_B.translation() - before.translation()).norm() > kJump_m ||
         T_W_B.rotation().angularDistance(before.rotation()) > kJump_rad;
}

void VehicleTracker::note(const Step& step) {
  tracking_ = is_tracking(step.status);
  if (!tracking_) return;
  if (jumps(step)) ++resets_;
  newest_ = {step.t, step.T_M_O, step.covariance, quality_of(step)};
}

std::optional<VehicleOdometry> VehicleTracker::at(const NavState& state, const Vector3d& gyro_B) const {
  if (!tracking_ || !newest_) return std::nullopt;
  const Quaterniond R_W_B = state.T_W_B.rotation();
  const Quaterniond R_V_W = R_V_B_ * R_W_B.conjugate();
  Quaterniond q = kFlip * R_V_W.conjugate();
  if (q.w() < 0.0) q.coeffs() *= -1.0;

  VehicleOdometry odometry;
  odometry.timestamp = odometry.timestamp_sample = microseconds(state.t);
  odometry.position = floats<3>(kFlip * state.T_W_B.translation());
  odometry.q = floats<4>({q.w(), q.x(), q.y(), q.z()});
  odometry.velocity = floats<3>(R_V_W * state.v_W);
  odometry.angular_velocity = floats<3>(R_V_B_ * (gyro_B - state.bias_gyro));
  odometry.reset_counter = resets_;
  odometry.quality = newest_->quality;

  Vector3d position = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), rotation = position,
           velocity = position;
  if (const auto& covariance = newest_->covariance) {
    // The correlations of the blocks are unknown: full correlation is the worst case, in which sigmas add up.
    const double ahead_s = std::max(0.0, to_seconds(state.t - newest_->t));
    const double tilt = sigmas(R_W_B.toRotationMatrix(), covariance->rotation).head<2>().norm();
    position = sigmas(kFlip.toRotationMatrix(), covariance->position) +
               ahead_s * sigmas(kFlip.toRotationMatrix(), covariance->velocity);
    position.array() += 0.5 * ahead_s * ahead_s * kGravity_W.norm() * tilt;
    rotation = sigmas(R_V_B_.toRotationMatrix(), covariance->rotation);
    velocity = sigmas(R_V_W.toRotationMatrix(), covariance->velocity).array() + ahead_s * kGravity_W.norm() * tilt;
  }
  odometry.position_variance = floats<3>(position.cwiseAbs2());
  odometry.orientation_variance = floats<3>(rotation.cwiseAbs2());
  odometry.velocity_variance = floats<3>(velocity.cwiseAbs2());
  return odometry;
}

}  // namespace edged
