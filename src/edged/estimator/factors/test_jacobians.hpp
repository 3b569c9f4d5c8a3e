// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A factor's analytic Jacobians against central differences over its tangent spaces.
#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/factors/factor.hpp"

namespace edged {

using Blocks = std::vector<std::vector<double>>;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline std::vector<double> pose_block(const SE3& T) {
  const PoseBlock block = to_block(T);
  return {block.begin(), block.end()};
}
inline std::vector<double> pose_block(const Eigen::Vector3d& phi, const Eigen::Vector3d& p) {
  return pose_block(SE3(so3::exp(phi), p));
}
inline std::vector<double> motion_numbers(const OdomState& s) {
  std::vector<double> motion;
  for (const Eigen::Vector3d& part : {s.v_O, s.bias_gyro, s.bias_accel}) {
    motion.insert(motion.end(), part.begin(), part.end());
  }
  return motion;
}

inline std::vector<double> plus(BlockKind kind, std::vector<double> x, const Eigen::VectorXd& d) {
  plus(kind, x.data(), d.data());
  return x;
}

inline Eigen::VectorXd evaluate(const ceres::CostFunction& cost, const Blocks& blocks) {
  std::vector<const double*> data;
  for (const auto& b : blocks) data.push_back(b.data());
  Eigen::VectorXd r(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(data.data(), r.data(), nullptr));
  return r;
}

/// Expects analytic and numeric Jacobians to be equal, relative to the largest entry of the block.
inline void check_jacobians(const ceres::CostFunction& cost, const std::vector<BlockKind>& kinds,
                            const Blocks& blocks) {
  std::vector<const double*> data;
  std::vector<RowMajorMatrix> J;
  std::vector<double*> J_data;
  for (const auto& b : blocks) data.push_back(b.data()), J.emplace_back(cost.num_residuals(), b.size());
  for (auto& j : J) J_data.push_back(j.data());
  Eigen::VectorXd r(cost.num_residuals());
  ASSERT_TRUE(cost.Evaluate(data.data(), r.data(), J_data.data()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int n = tangent_size(kinds[b]);
    Eigen::MatrixXd numeric(cost.num_residuals(), n);
    for (int k = 0; k < n; ++k) {
      Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
      Blocks moved = blocks;
      const double step = 1e-6;
      d[k] = step;
      moved[b] = plus(kinds[b], blocks[b], d);
      const Eigen::VectorXd up = evaluate(cost, moved);
      moved[b] = plus(kinds[b], blocks[b], -d);
      numeric.col(k) = (up - evaluate(cost, moved)) / (2 * step);
    }
    const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
    EXPECT_LT((J[b].leftCols(n) - numeric).cwiseAbs().maxCoeff() / scale, 1e-6) << "block " << b;
    if (kinds[b] == BlockKind::Pose) {
      EXPECT_EQ(J[b].col(6).cwiseAbs().maxCoeff(), 0.0);
    }
  }
}

inline void check_jacobians(const Factor& factor, const Blocks& blocks) {
  std::vector<BlockKind> kinds;
  for (const BlockKey& key : factor.blocks()) kinds.push_back(key.kind);
  check_jacobians(factor, kinds, blocks);
}

}  // namespace edged
