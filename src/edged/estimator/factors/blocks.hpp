// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The parameter blocks of the window and their tangent spaces. A factor writes its derivative by a pose's tangent into
// the first six of the seven columns that Ceres' cost functions have for it, and zero into the last.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>

#include "edged/camera/intrinsics.hpp"
#include "edged/se3.hpp"

namespace edged {

/// Names one state of the window; grows with time.
using StateId = std::uint64_t;

/// A pose block: position, then quaternion x y z w. Tangent (6): p' = p + d_p, q' = q * Exp(d_phi).
using PoseBlock = std::array<double, 7>;
/// A motion block: velocity, gyro bias, accelerometer bias.
using MotionBlock = std::array<double, 9>;

/// Correction of a camera's calibration: rotation phi [rad] with R_B_C = R_B_C,given * Exp(phi); time [s] with
/// t_imu = t_given + time; lever arm [m] with t_B_C = t_B_C,given + it; intrinsics (IntrinsicsCorrection).
inline constexpr int kTimeAt = calibration_at::kTime, kLeverArmAt = calibration_at::kLeverArm,
                     kIntrinsicsAt = calibration_at::kFocal, kCentreAt = calibration_at::kCentre,
                     kCalibrationSize = calibration_at::kSize;
static_assert(kCalibrationSize == kIntrinsicsAt + kIntrinsics);
using CalibrationBlock = std::array<double, kCalibrationSize>;
using CalibrationVector = Eigen::Matrix<double, kCalibrationSize, 1>;

/// Errors of scale and axes of the IMU: E_g row by row, then E_a. measured = (I + E) true + bias.
using ImuIntrinsicsBlock = std::array<double, 18>;

enum class BlockKind : std::uint8_t {
  Pose,
  Motion,
  InverseDepth,
  LogScale,
  HeightBias,
  VelocityScale,
  Calibration,
  ImuIntrinsics
};

/// Names one parameter block: a state's pose or motion, a feature's inverse depth, ln s of the depth source (Eq. 5),
/// the bias of a height sensor, the scale error of a velocity sensor, the calibration of a camera, or that of the IMU.
struct BlockKey {
  BlockKind kind;
  std::uint64_t id;  ///< state number, FeatureId, number of the block (RandomWalkParameter), index of the camera, or 0
  auto operator<=>(const BlockKey&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 sees a null in it
};

/// The one block of the IMU's scale and axes.
inline constexpr BlockKey kImuIntrinsicsKey{BlockKind::ImuIntrinsics, 0};

/// Whether the block is the calibration of a camera or of the IMU.
constexpr bool is_calibration(BlockKey key) {
  return key.kind == BlockKind::Calibration || key.kind == BlockKind::ImuIntrinsics;
}

constexpr int block_size(BlockKind kind) {
  switch (kind) {
    case BlockKind::Pose:
      return 7;
    case BlockKind::Motion:
      return 9;
    case BlockKind::Calibration:
      return kCalibrationSize;
    case BlockKind::ImuIntrinsics:
      return 18;
    default:
      return 1;
  }
}
constexpr int tangent_size(BlockKind kind) { return kind == BlockKind::Pose ? 6 : block_size(kind); }

inline PoseBlock to_block(const SE3& T) {
  const auto& p = T.translation();
  const auto& q = T.rotation();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}
inline SE3 pose_of(const double* block) {
  return {Eigen::Quaterniond(block[6], block[3], block[4], block[5]), Eigen::Vector3d(block[0], block[1], block[2])};
}

/// x minus x0 in the tangent space of the block: the step from x0 to x. `difference` holds tangent_size(kind) numbers.
inline void tangent_difference(BlockKind kind, const double* x, const double* x0, double* difference) {
  if (kind != BlockKind::Pose) {
    for (int i = 0; i < block_size(kind); ++i) difference[i] = x[i] - x0[i];
    return;
  }
  const SE3 T = pose_of(x), T0 = pose_of(x0);
  Eigen::Map<Vector6d> d(difference);
  d << T.translation() - T0.translation(), so3::log(T0.rotation().conjugate() * T.rotation());
}

/// x moved by d in the tangent space of the block: undone by tangent_difference.
inline void plus(BlockKind kind, double* x, const double* d) {
  if (kind != BlockKind::Pose) {
    for (int i = 0; i < block_size(kind); ++i) x[i] += d[i];
    return;
  }
  const SE3 T = pose_of(x);
  const Eigen::Map<const Eigen::Vector3d> d_p(d), d_phi(d + 3);
  const PoseBlock moved = to_block(SE3(T.rotation() * so3::exp(d_phi), T.translation() + d_p));
  std::copy(moved.begin(), moved.end(), x);
}

}  // namespace edged
