// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The unknowns of a rig and their cost, as blocks of Ceres.
#pragma once

#include <ceres/problem.h>

#include <array>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "edged/calibrate/lens_fit.hpp"
#include "edged/calibrate/reprojection.hpp"
#include "edged/estimator/factors/blocks.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {

/// The body at the time of one or more views.
struct RigState {
  Timestamp t;  ///< IMU clock; without IMU the cameras'
  PoseBlock T_W_B{};
  MotionBlock motion{};
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();        ///< reading at that time
  std::vector<std::pair<std::size_t, std::size_t>> views;  ///< camera, index of its view
};

struct CameraBlocks {
  PoseBlock T_B_C{};
  double time_offset_s = 0.0;  ///< at which the states lie
  double correction_s = 0.0;   ///< correction of time_offset_s
  LensParameters lens{};
};

/// All unknowns; the target lies at the origin of W, which has z up.
struct RigUnknowns {
  std::vector<RigState> states;
  std::vector<CameraBlocks> cameras;
  Eigen::Quaterniond R_W_T = Eigen::Quaterniond::Identity();
  std::array<double, 2> tilt{};
};

class RigProblem {
 public:
  RigProblem(RigUnknowns& unknowns, const std::vector<TargetCamera>& cameras, const TargetLayout& layout,
             std::span<const ImuSample> imu, const ImuNoise& noise);

  void solve(int most_steps);
  /// Moves what the corrections are relative to, so that they are zero.
  void apply_corrections();
  /// Blocks of T_B_C (6), clock and lens (kLensParameters), one camera after the other; 0 where nothing is estimated.
  /// The larger of two variances: by the sigmas of the corners, as if these erred by themselves, and by how far the
  /// views contradict each other, which contains what the model of the lens misses (the sandwich estimator with a
  /// cluster for each state; Liang and Zeger, Biometrika 73, 1986).
  Eigen::VectorXd calibration_variances();
  double imu_misfit() const;

 private:
  void add_views(const std::vector<TargetCamera>& cameras, const TargetLayout& layout);
  void add_imu(std::span<const ImuSample> imu, const ImuNoise& noise);
  void fix_known_parameters(const std::vector<TargetCamera>& cameras);

  RigUnknowns& unknowns_;
  bool has_imu_;
  PoseBlockManifold pose_manifold_;
  std::deque<ceres::SubsetManifold> lens_manifolds_;
  std::deque<Preintegration> motions_;
  std::vector<ceres::ResidualBlockId> terms_;  ///< all of them, in the order of the states
  std::vector<int> rows_;                      ///< residuals of each state's views, then of each other term
  std::vector<ceres::ResidualBlockId> imu_terms_;
  ImuIntrinsicsBlock imu_intrinsics_{};
  ceres::Problem problem_;
};

}  // namespace edged
