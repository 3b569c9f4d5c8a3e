// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/trajectory/pose_graph.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

const SE3 kStep(so3::exp({0.0, 0.0, 0.1}), {0.1, 0.02, 0.0});
const SE3 kDrifted(so3::exp({0.0, 0.0, 0.11}), {0.1, 0.02, 0.004});
constexpr std::size_t kPoses = 20;

double distance(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).norm() + so3::log(a.rotation().conjugate() * b.rotation()).norm();
}

/// Steps of an odometry that drifts by the same each time.
struct Chain {
  PoseGraph graph;
  std::vector<SE3> truth = {SE3()};

  Chain() {
    SE3 guess;
    graph.add_pose(guess);
    for (std::size_t k = 1; k < kPoses; ++k) {
      truth.push_back(truth.back() * kStep);
      guess = guess * kDrifted;
      graph.add_pose(guess);
      graph.add_step(k - 1, k, kDrifted, 1e-4 * Matrix6d::Identity());
    }
  }
};

/// Points of keyframe 0, observed from the last pose.
std::vector<MapObservation> observations_from_last(const Chain& chain) {
  std::vector<MapObservation> observations;
  for (const double x : {-0.5, 0.0, 0.5}) {
    for (const double y : {-0.5, 0.0, 0.5}) {
      const Eigen::Vector3d p_K = chain.truth.back() * Eigen::Vector3d(x, y, 3.0 + x * y);
      const Eigen::Vector3d p_B = chain.truth.back().inverse() * p_K;
      observations.push_back({0, p_K, Eigen::Vector3d::Zero(), p_B.hnormalized(), 0.001});
    }
  }
  return observations;
}

TEST(PoseGraph, LeavesAllWhereItWasWhenNothingContradicts) {
  Chain chain;
  const std::vector<SE3> before = chain.graph.poses();
  chain.graph.solve();
  for (std::size_t k = 0; k < kPoses; ++k) EXPECT_LT(distance(before[k], chain.graph.poses()[k]), 1e-12);
}

TEST(PoseGraph, StraightensALoopWhoseDriftIsKnown) {
  Chain chain;
  const double off = distance(chain.graph.poses().back(), chain.truth.back());
  ASSERT_GT(off, 0.1);
  chain.graph.add_observations(kPoses - 1, {SE3()}, observations_from_last(chain));
  chain.graph.solve();
  EXPECT_LT(distance(chain.graph.poses().front(), SE3()), 1e-12) << "the first one stays";
  EXPECT_LT(distance(chain.graph.poses().back(), chain.truth.back()), 0.05 * off);
  const std::size_t middle = kPoses / 2;
  EXPECT_LT(distance(chain.graph.poses()[middle], chain.truth[middle]), 0.2 * off) << "the drift is spread evenly";
}

TEST(PoseGraph, KeepsEachPoseUpright) {
  const SE3 rolled(so3::exp({0.02, 0.0, 0.0}), {0.1, 0.0, 0.0});
  PoseGraph graph;
  SE3 guess;
  graph.add_pose(guess);
  for (std::size_t k = 1; k < kPoses; ++k) {
    guess = guess * rolled;
    graph.add_pose(guess);
    graph.add_step(k - 1, k, rolled, 1e-3 * Matrix6d::Identity());
    graph.add_gravity(k, observed_gravity(SE3(), 1.0));
  }
  graph.solve();
  for (const SE3& pose : graph.poses()) EXPECT_LT(so3::log(pose.rotation()).norm(), 0.02);
  EXPECT_NEAR(graph.poses().back().translation().x(), 0.1 * (kPoses - 1), 1e-3);
}

TEST(PoseGraph, IsHardlyMovedByAPointThatIsWrong) {
  Chain right, wrong;
  std::vector<MapObservation> observations = observations_from_last(right);
  right.graph.add_observations(kPoses - 1, {SE3()}, observations);
  observations[3].seen.x() += 0.02;
  wrong.graph.add_observations(kPoses - 1, {SE3()}, observations);
  right.graph.solve();
  wrong.graph.solve();
  EXPECT_LT(distance(right.graph.poses().back(), wrong.graph.poses().back()), 0.002);
}

TEST(PoseGraph, IgnoresAPointThatLiesBehind) {
  Chain chain;
  const std::vector<SE3> before = chain.graph.poses();
  chain.graph.add_observations(kPoses - 1, {SE3()},
                               std::vector<MapObservation>{{0, {0, 0, -9}, {0, 0, 0}, {0, 0}, 0.001}});
  chain.graph.solve();
  EXPECT_LT(distance(before.back(), chain.graph.poses().back()), 1e-12);
}

}  // namespace
}  // namespace edged
