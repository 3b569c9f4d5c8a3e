// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A body that circles a wall of points, and odometry with a constant drift per step.
#include "edged/map/trajectory/trajectory_smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr double kTick_s = 0.1, kOnceRound_s = 8.0;

Timestamp instant(double t_s) { return timestamp_from_seconds(t_s); }

SE3 true_pose(double t) {
  const double a = 2.0 * M_PI * t / kOnceRound_s;
  return {so3::exp({0.0, 0.0, 0.2 * std::sin(a)}), {0.5 * std::sin(a), 0.5 - 0.5 * std::cos(a), 0.0}};
}

class FlightRecordTest : public testing::Test {
 protected:
  void restart(double t, const SE3& T_M_O) {
    T_O_B_ = T_M_O.inverse() * true_pose(t);
    T_M_O_ = T_M_O;
    record_.restart({instant(t), T_O_B_}, 0.1, 0.05);
    odom_to_map_.restart(instant(t));
    odom_to_map_.correct(instant(t), T_M_O);
  }
  /// Steps of odometry that drifts to the side, up to that time.
  void fly(double from, double to, double drift_m = 0.001) {
    for (double t = from + kTick_s; t < to + 1e-6; t += kTick_s) {
      T_O_B_ = T_O_B_ * (true_pose(t - kTick_s).inverse() * true_pose(t)) *
               SE3(Eigen::Quaterniond::Identity(), {drift_m, 0, 0});
      add(t);
    }
  }
  void add(double t) {
    record_.add({instant(t), T_O_B_});
    causal_.push_back({instant(t), T_M_O_ * T_O_B_});
  }
  /// The points of that keyframe on the wall, observed from the true pose of the body.
  void observe(double t, double made_at, std::size_t keyframe) {
    std::vector<MapObservation> observations;
    for (const double x : {-1.2, 0.1, 1.3}) {
      for (const double y : {-1.1, 0.0, 1.0}) {
        const Eigen::Vector3d p(x, y, 3.0 + x + 0.8 * y);  // not one plane: rotation and translation are separable
        const Eigen::Vector3d p_K = true_pose(made_at).inverse() * p, p_B = true_pose(t).inverse() * p;
        observations.push_back({static_cast<std::uint32_t>(keyframe), p_K, 0.0002 * p_K, p_B.hnormalized(), 0.0002});
      }
    }
    record_.add_observations({instant(t), T_O_B_}, {SE3()}, observations);
    odom_to_map_.correct(instant(t), T_M_O_);
  }
  Trajectory path() const { return record_.path(odom_to_map_, record_.solve(odom_to_map_)); }
  static double error(const StampedPose& pose) {
    const double t = to_seconds(pose.t - Timestamp{});
    return (pose.T.translation() - true_pose(t).translation()).norm();
  }

  TrajectorySmoother record_;
  OdomToMap odom_to_map_;
  SE3 T_O_B_, T_M_O_;
  Trajectory causal_;
};

TEST_F(FlightRecordTest, GivesBackWhatWasToldWhereNothingWasFoundAgain) {
  restart(0.0, SE3());
  fly(0.0, 4.0);
  record_.refine({instant(2.0), SE3()});
  record_.add_keyframe({instant(2.0), causal_[19].T});
  restart(5.0, SE3(so3::exp({0, 0, 0.3}), {0.1, 0.2, 0.3}));
  fly(5.0, 7.0);
  const Trajectory path = this->path();
  ASSERT_EQ(path.size(), causal_.size());
  for (std::size_t i = 0; i < causal_.size(); ++i) {
    EXPECT_EQ(path[i].t, causal_[i].t);
    EXPECT_EQ(path[i].T.translation(), causal_[i].T.translation());
    EXPECT_EQ(path[i].T.rotation().coeffs(), causal_[i].T.rotation().coeffs());
  }
  EXPECT_EQ(record_.solve(odom_to_map_).keyframes.size(), 1U);
}

TEST_F(FlightRecordTest, IsEmptyBeforeAnything) {
  EXPECT_TRUE(path().empty());
  restart(0.0, SE3());
  EXPECT_TRUE(path().empty());
}

TEST_F(FlightRecordTest, SpreadsTheDriftOfARoundOverItOnceThePlaceIsFoundAgain) {
  restart(0.0, SE3());
  fly(0.0, 0.5, 0.0);
  const std::size_t keyframe = record_.add_keyframe({instant(0.5), T_O_B_});
  fly(0.5, 8.5);
  ASSERT_GT(error(causal_.back()), 0.06);
  observe(8.5, 0.5, keyframe);
  const Trajectory poses = path();
  EXPECT_LT(error(poses.back()), 0.005);
  for (const StampedPose& pose : poses) EXPECT_LT(error(pose), 0.01);
}

TEST_F(FlightRecordTest, FitsAllLooksOfALongFlightThoughOnlySomeMoveTheKeyframes) {
  constexpr double kFirst_s = 1.0, kInterval_s = 0.5, kLong_s = 180.0;  // 1700 matched images
  restart(0.0, SE3());
  std::vector<double> made_at;
  double t = 0.0;
  for (; t < kLong_s; t += kTick_s) {
    fly(t, t + kTick_s, t < kFirst_s ? 0.0 : 0.001);
    const double now = t + kTick_s;
    if (now < kOnceRound_s && now > kFirst_s + kInterval_s * static_cast<double>(made_at.size()) - 1e-6) {
      record_.add_keyframe({instant(now), T_O_B_});
      made_at.push_back(now);
    } else if (now > kOnceRound_s) {
      const std::size_t keyframe = static_cast<std::size_t>(10.0 * now) % made_at.size();
      T_M_O_ = true_pose(now) * T_O_B_.inverse();
      observe(now, made_at[keyframe], keyframe);
    }
  }
  ASSERT_GT(error(std::ranges::max(causal_, {}, error)), 0.05) << "it drifts until a place is observed again";
  const Trajectory path = this->path();
  ASSERT_EQ(path.size(), causal_.size());
  for (const StampedPose& pose : path) EXPECT_LT(error(pose), 0.003) << to_seconds(pose.t - Timestamp{}) << " s";
}

TEST_F(FlightRecordTest, TakesKeyframesForWhatTheyHadBecomeWhenTheyLeft) {
  restart(0.0, SE3());
  fly(0.0, 0.5, 0.0);
  const std::size_t keyframe = record_.add_keyframe({instant(0.5), T_O_B_});
  fly(0.5, 4.0, 0.0);
  T_O_B_.translation().z() += 0.01;  // one wrong causal pose, corrected within the window
  fly(4.0, 4.1, 0.0);
  T_O_B_.translation().z() -= 0.01;
  fly(4.1, 8.5, 0.0);
  for (const double t : {4.0, 4.1, 4.2}) record_.refine({instant(t), true_pose(t)});
  observe(8.5, 0.5, keyframe);
  for (const StampedPose& pose : path()) EXPECT_LT(error(pose), 1e-3);
}

TEST_F(FlightRecordTest, InterpolatesNothingAcrossANewStart) {
  restart(0.0, SE3());
  fly(0.0, 0.5, 0.0);
  const std::size_t keyframe = record_.add_keyframe({instant(0.5), T_O_B_});
  fly(0.5, 3.0, 0.0);
  observe(3.0, 0.5, keyframe);
  // The new frame is at the pose of dead reckoning, half a metre off, with a yaw error.
  const SE3 off(Eigen::Quaterniond::Identity(), {0.5, -0.2, 0.0}), O(so3::exp({0, 0, 1.0}), {1.0, 2.0, 0.5});
  T_O_B_ = O.inverse() * true_pose(5.0);
  T_M_O_ = off * O;
  record_.restart({instant(5.0), T_O_B_}, 0.1, 0.05);
  odom_to_map_.restart(instant(5.0));
  odom_to_map_.correct(instant(5.0), T_M_O_);
  fly(5.0, 8.0, 0.0);
  EXPECT_GT(error(causal_.back()), 0.5);
  T_M_O_ = O;
  observe(8.0, 0.5, keyframe);
  odom_to_map_.drop_dead_reckoning();
  fly(8.0, 8.5, 0.0);
  for (const StampedPose& pose : path()) EXPECT_LT(error(pose), 0.005) << to_seconds(pose.t - Timestamp{}) << " s";
}

TEST_F(FlightRecordTest, ComesAsAWholeIntoTheMapOfAnotherRun) {
  const std::vector<SE3> loaded = {true_pose(7.0), true_pose(7.5)};
  record_.load(loaded);
  // Two starts in a frame of this run's own, before relocalization in the map.
  const SE3 own(so3::exp({0, 0, -0.7}), {2.0, 1.0, 0.0});
  restart(0.0, own);
  fly(0.0, 3.0, 0.0);
  restart(5.0, own);
  fly(5.0, 8.0, 0.0);
  observe(8.0, 7.5, 1);
  odom_to_map_.drop_dead_reckoning();
  const Trajectory path = this->path();
  EXPECT_EQ(path.size(), causal_.size());
  for (const StampedPose& pose : path) EXPECT_LT(error(pose), 0.005) << to_seconds(pose.t - Timestamp{}) << " s";
  const std::vector<SE3> keyframes = record_.solve(odom_to_map_).keyframes;
  for (std::size_t k = 0; k < loaded.size(); ++k) {
    EXPECT_LT((keyframes[k].inverse() * loaded[k]).log().norm(), 1e-6);
  }
}

TEST_F(FlightRecordTest, MovesWhatWasBeforeIntoTheMapsFrame) {
  const SE3 own(so3::exp({0, 0, -0.7}), {2.0, 1.0, 0.0});
  restart(0.0, own);
  fly(0.0, 1.0, 0.0);
  restart(2.0, own);
  fly(2.0, 3.0, 0.0);
  odom_to_map_.transform_earlier(own.inverse());
  const Trajectory moved = path();
  EXPECT_LT((moved.front().T.inverse() * own.inverse() * causal_.front().T).log().norm(), 1e-12);
  EXPECT_EQ(moved.back().T.matrix(), causal_.back().T.matrix()) << "the map has corrected the present start";
}

}  // namespace
}  // namespace edged
