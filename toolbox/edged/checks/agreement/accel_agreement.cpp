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
constexpr double kLeastPush = 0.5;                               // [m/s^2]

/// A rotation in the axes of the first IMU sample.
struct Way {
  Timestamp begin, middle, end;  ///< on the IMU's clock
  Eigen::Vector3d direction;
};

std::vector<Way> ways_of(std::span<const Turn> turns, const GyroIntegral& imu, const GyroMount& mount) {
  const Duration shift = duration_from_seconds(mount.shift_s);
  std::vector<Way> ways;
  for (const Turn& turn : turns) {
    if (turn.rays.empty()) continue;
    const Timestamp begin = turn.begin + shift, end = turn.end + shift;
    const auto phi_B = imu.turn_between(begin, end);
    const auto q_0_B = imu.attitude_at(begin);
    if (!phi_B || !q_0_B) continue;
    const Eigen::Vector3d right = *phi_B / mount.gyro_scale - mount.bias * to_seconds(end - begin);
    const Eigen::Matrix3d R = so3::exp(mount.R_B_C.transpose() * right).toRotationMatrix();
    const Eigen::Vector3d way = way_of(turn, R);
    if (!way.isZero()) ways.push_back({begin, begin + (end - begin) / 2, end, *q_0_B * (mount.R_B_C * way)});
  }
  return ways;
}

/// Specific force between two stamps minus its mean around them, as a change of velocity [m/s].
std::optional<Eigen::Vector3d> push_between(const GyroIntegral& imu, Timestamp begin, Timestamp end) {
  const Timestamp from = std::max(imu.first(), begin - kAround);
  const Timestamp to = std::min(imu.last() - Duration(1), end + kAround);
  if (to - from < kLeastAround) return std::nullopt;
  const auto all = imu.pushed_between(from, to), part = imu.pushed_between(begin, end);
  if (!all || !part) return std::nullopt;
  return *part - to_seconds(end - begin) / to_seconds(to - from) * *all;
}

}  // namespace

AccelAgreement compare_with_accel(std::span<const Turn> turns, const GyroIntegral& imu, const GyroMount& mount) {
  const std::vector<Way> ways = ways_of(turns, imu, mount);
  AccelAgreement result;
  if (imu.empty()) return result;
  double both = 0.0, seen = 0.0, felt = 0.0;
  for (const Way& way : ways) {
    const auto next = std::ranges::lower_bound(ways, way.end, {}, &Way::begin);
    if (next == ways.end() || next->begin - way.end > kLongestGap) continue;
    const auto push = push_between(imu, way.middle, next->middle);
    if (!push || push->norm() < kLeastPush * to_seconds(next->middle - way.middle)) continue;
    const auto across = [&way](const Eigen::Vector3d& v) -> Eigen::Vector3d {
      return v - v.dot(way.direction) * way.direction;
    };
    const Eigen::Vector3d turned = across(next->direction), pushed = across(*push).normalized();
    both += turned.dot(pushed);
    seen += turned.squaredNorm();
    felt += pushed.squaredNorm();
    ++result.turns;
  }
  if (result.turns > 0) result.correlation = both / std::sqrt(std::max(seen * felt, 1e-12));
  return result;
}

}  // namespace edged
