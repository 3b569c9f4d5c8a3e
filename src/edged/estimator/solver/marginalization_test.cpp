// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/marginalization.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

TEST(Marginalize, LeavesTheSolutionOfTheRemainingStatesWhereItWas) {
  TestWorld world({.bias_gyro = {0.001, 0, 0}, .bias_accel = {0.01, 0.02, 0}});
  Window window = inertial_window(world);
  solve(window, 50);
  const PoseBlock solved = window.newest().pose;
  const MotionBlock solved_motion = window.newest().motion;

  const StateId first = window.oldest_id();
  const std::set<BlockKey> leaving = {{BlockKind::Pose, first}, {BlockKind::Motion, first}};
  Cost touching = cost_of(window);
  std::erase_if(touching.factors, [&](const auto& factor) { return !factor->marginalized_with(leaving); });
  window.drop_oldest(marginalize(window, touching, leaving));

  // Start from other values: the prior alone must bring the states back.
  for (const auto& [id, state] : window.states()) {
    window.move({BlockKind::Pose, id}, std::array{0.02, 0.02, 0.02, 0.0, 0.0, 0.0});
    window.move({BlockKind::Motion, id}, std::vector<double>(9, 0.01));
  }
  solve(window, 50);
  double difference[9];
  tangent_difference(BlockKind::Pose, window.newest().pose.data(), solved.data(), difference);
  EXPECT_LT(Eigen::Map<Vector6d>(difference).norm(), 1e-4);
  tangent_difference(BlockKind::Motion, window.newest().motion.data(), solved_motion.data(), difference);
  EXPECT_LT((Eigen::Map<Eigen::Matrix<double, 9, 1>>(difference).norm()), 2e-4);
}

TEST(Marginalize, KeepsTheInformationOfTheNormalEquations) {
  TestWorld world({});
  Window window = inertial_window(world);
  const Cost cost = cost_of(window);
  const LinearPrior prior = marginalize(window, cost, {});  // nothing leaves: J^T J is H, J^T r is g
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(prior.J.cols(), prior.J.cols());
  Eigen::VectorXd g = Eigen::VectorXd::Zero(prior.J.cols());
  for (const auto& factor : cost.factors) {
    Eigen::VectorXd r(factor->num_residuals());
    std::vector<const double*> x;
    std::vector<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J;
    std::vector<double*> J_data;
    for (const BlockKey& key : factor->blocks()) {
      x.push_back(window.block(key));
      J.emplace_back(r.size(), block_size(key.kind));
    }
    for (auto& j : J) J_data.push_back(j.data());
    ASSERT_TRUE(factor->Evaluate(x.data(), r.data(), J_data.data()));
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(r.size(), H.cols());
    for (std::size_t i = 0; i < J.size(); ++i) {
      Eigen::Index offset = 0;
      for (const BlockKey& key : prior.blocks) {
        if (key == factor->blocks()[i])
          row.middleCols(offset, tangent_size(key.kind)) = J[i].leftCols(tangent_size(key.kind));
        offset += tangent_size(key.kind);
      }
    }
    H += row.transpose() * row;
    g += row.transpose() * r;
  }
  EXPECT_LT((prior.J.transpose() * prior.J - H).norm() / H.norm(), 1e-9);
  EXPECT_LT((prior.J.transpose() * prior.r - g).norm() / std::max(1.0, g.norm()), 1e-6);
}

}  // namespace
}  // namespace edged
