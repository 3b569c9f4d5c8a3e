// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/accel_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace edged {
namespace {

constexpr Duration kAround = std::chrono::seconds(2);  // averaging time for gravity; other accelerations average out
constexpr Duration kLeastAround = std::chrono::milliseconds(2500);
constexpr Duration kLongestGap = std::chrono::milliseconds(60);  // between two turns
constexpr double kLeastAcceleration = 0.5;                       // [m/s^2]

/// A rotation in the axes of the first IMU sample.
struct Displacement {
  Timestamp begin, middle, end;  ///< on the IMU's clock
  Eigen::Vector3d direction;
};

std::vector<Displacement> displacements_of(std::span<const Turn> turns, const GyroIntegral& imu,
                                           const GyroMount& mount) {
  const Duration shift = duration_from_seconds(mount.shift_s);
  std::vector<Displacement> displacements;
  for (const Turn& turn : turns) {
    if (turn.rays.empty()) continue;
    const Timestamp begin = turn.begin + shift, end = turn.end + shift;
    const auto phi_B = imu.rotation_vector(begin, end);
    const auto q_0_B = imu.attitude_at(begin);
    if (!phi_B || !q_0_B) continue;
    const Eigen::Vector3d right = *phi_B / mount.gyro_scale - mount.bias * to_seconds(end - begin);
    const Eigen::Matrix3d R = so3::exp(mount.R_B_C.transpose() * right).toRotationMatrix();
    const Eigen::Vector3d displacement = translation_direction(turn, R);
    if (!displacement.isZero())
      displacements.push_back({begin, begin + (end - begin) / 2, end, *q_0_B * (mount.R_B_C * displacement)});
  }
  return displacements;
}

/// Specific force between two stamps minus its mean around them, as a change of velocity [m/s].
std::optional<Eigen::Vector3d> velocity_change_without_gravity(const GyroIntegral& imu, Timestamp begin,
                                                               Timestamp end) {
  const Timestamp from = std::max(imu.first(), begin - kAround);
  const Timestamp to = std::min(imu.last() - Duration(1), end + kAround);
  if (to - from < kLeastAround) return std::nullopt;
  const auto all = imu.velocity_change(from, to), part = imu.velocity_change(begin, end);
  if (!all || !part) return std::nullopt;
  return *part - to_seconds(end - begin) / to_seconds(to - from) * *all;
}

}  // namespace

AccelAgreement compare_with_accel(std::span<const Turn> turns, const GyroIntegral& imu, const GyroMount& mount) {
  const std::vector<Displacement> displacements = displacements_of(turns, imu, mount);
  AccelAgreement result;
  if (imu.empty()) return result;
  double both = 0.0, visual = 0.0, inertial = 0.0;
  for (const Displacement& displacement : displacements) {
    const auto next = std::ranges::lower_bound(displacements, displacement.end, {}, &Displacement::begin);
    if (next == displacements.end() || next->begin - displacement.end > kLongestGap) continue;
    const auto change = velocity_change_without_gravity(imu, displacement.middle, next->middle);
    if (!change || change->norm() < kLeastAcceleration * to_seconds(next->middle - displacement.middle)) continue;
    const auto across = [&displacement](const Eigen::Vector3d& v) -> Eigen::Vector3d {
      return v - v.dot(displacement.direction) * displacement.direction;
    };
    const Eigen::Vector3d turned = across(next->direction), accelerated = across(*change).normalized();
    both += turned.dot(accelerated);
    visual += turned.squaredNorm();
    inertial += accelerated.squaredNorm();
    ++result.turns;
  }
  if (result.turns > 0) result.correlation = both / std::sqrt(std::max(visual * inertial, 1e-12));
  return result;
}

}  // namespace edged
