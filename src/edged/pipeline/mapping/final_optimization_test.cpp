// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Flights of the estimator through a world of points, recorded as by the mapper.
#include "edged/pipeline/mapping/final_optimization.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "edged/estimator/test_tracks.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/options.hpp"

namespace edged {
namespace {

// Tracks drift from their points, and so does the odometry.
const TestWorldOptions kDrifting{.rest_s = 1.0, .pixel_noise = 0.1, .pixel_walk = 0.5};

double seconds(Timestamp t) { return to_seconds(t - Timestamp{}); }

class FinalOptimization : public testing::Test {
 protected:
  FinalOptimization() : world_(kDrifting) {}

  /// A start of the estimator, whose frame O is in M as given.
  void fly(double from_s, double to_s, const SE3& T_M_O = {}) {
    Estimator estimator(world_.rig(), world_.noise(), {});
    TracksOnce tracks;
    bool started = false;
    for (int i = static_cast<int>(from_s / kPacket_s) + 1; i * kPacket_s <= to_s; ++i) {
      const double t = i * kPacket_s;
      EstimatorInput input = world_.packet(t, kPacket_s, i % 4 == 0);
      tracks.rename(input);
      const EstimatorResult result = estimator.add(input);
      if (!estimator.initialized()) continue;
      T_O_B_ = estimator.newest().T_O_B;
      const StampedPose now{timestamp_from_seconds(t), T_O_B_};
      if (!std::exchange(started, true)) {
        record_.restart(now, 0.1, 0.05);
        odom_to_map_.restart(now.t);
        odom_to_map_.correct(now.t, T_M_O * world_.T_W_B(t) * T_O_B_.inverse());
      }
      record_.add(now);
      for (const MarginalizedKeyframe& keyframe : result.marginalized_keyframes) {
        record_.refine({keyframe.t, keyframe.T_O_B});
        keyframes_.emplace_back(seconds(keyframe.t), record_.add_keyframe({keyframe.t, keyframe.T_O_B}));
      }
      observe(t);
    }
    starts_.push_back(estimator.record());
  }

  /// Points of an early keyframe, observed without an error.
  void observe(double t) {
    if (!matches_ || t < 12.0 || std::fmod(t, 0.5) > 0.5 * kPacket_s) return;
    const auto& [made_at, number] = keyframes_[3];
    std::vector<MapObservation> observations;
    const SE3 T_B_C = world_.rig().cameras.front().T_B_C;
    for (const FeatureObservation& seen : world_.observe(t).features) {
      const Eigen::Vector3d &p = world_.point_W(seen.id), p_K = world_.T_W_B(made_at).inverse() * p;
      const Eigen::Vector3d p_C = (world_.T_W_B(t) * T_B_C).inverse() * p;
      observations.push_back({static_cast<std::uint32_t>(number), p_K, 1e-3 * p_K, p_C.hnormalized(), 1e-3});
    }
    record_.add_observations({timestamp_from_seconds(t), T_O_B_}, {T_B_C}, observations);
  }

  Trajectory final_path() {
    TrajectorySmoother::Solution solution = record_.solve(odom_to_map_);
    cost_ = {};
    shares_.clear();
    const Trajectory placed =
        optimize_jointly(record_, starts_, solution, cost_, [this](double share) { shares_.push_back(share); });
    return record_.path(odom_to_map_, solution, placed);
  }
  /// The largest position error from some time on, all poses aligned at the first one.
  double error(const Trajectory& poses, double since_s = 0.0) const {
    const SE3 T = alignment_at(world_.T_W_B(seconds(poses.front().t)), poses.front().T);
    double worst = 0.0;
    for (const auto& [t, T_M_B] : poses) {
      const SE3 truth = world_.T_W_B(seconds(t));
      if (seconds(t) >= since_s) worst = std::max(worst, ((T * T_M_B).translation() - truth.translation()).norm());
    }
    return worst;
  }
  Trajectory causal_path() const { return record_.path(odom_to_map_, record_.solve(odom_to_map_)); }

  TestWorld world_;
  TrajectorySmoother record_;
  OdomToMap odom_to_map_;
  SE3 T_O_B_;
  std::vector<StartRecord> starts_;
  std::vector<std::pair<double, std::size_t>> keyframes_;  ///< made at, number
  FinalCost cost_;
  std::vector<double> shares_;  ///< of the steps that were done
  bool matches_ = false;
};

TEST_F(FinalOptimization, OfNothingIsNothing) {
  starts_.emplace_back();
  EXPECT_TRUE(final_path().empty());
  EXPECT_TRUE(shares_.empty());
  EXPECT_EQ(cost_.after, 0.0);
}

TEST_F(FinalOptimization, ImprovesAFlightThatNeverComesBack) {
  fly(0.0, 20.0);
  const Trajectory poses = final_path();
  EXPECT_LT(cost_.after, cost_.before);
  EXPECT_LT(error(poses), error(causal_path()));
  EXPECT_EQ(poses.size(), causal_path().size());
}

TEST_F(FinalOptimization, PullsDriftBackByMapMatches) {
  fly(0.0, 24.0);
  const double without = error(final_path(), 20.0);
  record_ = TrajectorySmoother();
  odom_to_map_ = {};
  keyframes_.clear();
  starts_.clear();
  world_ = TestWorld(kDrifting);
  matches_ = true;
  fly(0.0, 24.0);
  const double with = error(final_path(), 20.0);
  EXPECT_LT(with, 0.7 * without);
  EXPECT_LT(cost_.after, cost_.before);
}

TEST_F(FinalOptimization, PlacesALaterStartByTheKeyframesOfAnEarlierOne) {
  fly(0.0, 11.0);
  matches_ = true;
  fly(14.0, 24.0, SE3(so3::exp({0.0, 0.0, 0.02}), {0.05, -0.04, 0.0}));  // dead reckoning was off
  const Trajectory poses = final_path();
  EXPECT_LT(error(poses, 14.0), 0.04) << "dead reckoning was off by 0.064, and turned";
  EXPECT_TRUE(std::ranges::is_sorted(shares_));
  EXPECT_GT(shares_.back(), 11.0 / 21.0) << "of both starts";
  EXPECT_LE(shares_.back(), 1.0);
  EXPECT_LT(cost_.after, cost_.before);
}

TEST_F(FinalOptimization, HasOneSolutionToTheLastBit) {
  matches_ = true;
  fly(0.0, 16.0);
  const Trajectory one = final_path(), two = final_path();
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].T.matrix(), two[i].T.matrix());
}

}  // namespace
}  // namespace edged
