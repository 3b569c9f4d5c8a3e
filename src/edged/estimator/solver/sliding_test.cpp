// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Factors, observations and landmarks when a state leaves the window.
#include "edged/estimator/solver/sliding.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/standstill_factor.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {
namespace {

/// A measurement of the position of a state, which moves to the state before, or ends.
class PositionFactor final : public Factor {
 public:
  PositionFactor(StateId state, int measurements, bool moves)
      : Factor(3, {{BlockKind::Pose, state}}), measurements_(measurements), moves_(moves) {}
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    std::copy_n(blocks[0], 3, residuals);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>>{jacobians[0]}.setIdentity();
    return true;
  }
  std::shared_ptr<Factor> without(const DroppedState& dropped) const override {
    return moves_ ? std::make_shared<PositionFactor>(dropped.before, measurements_, true) : nullptr;
  }
  bool merge(const Factor& other) override {
    const auto* position = dynamic_cast<const PositionFactor*>(&other);
    if (position == nullptr) return false;
    measurements_ += position->measurements_;
    return true;
  }
  int measurements() const { return measurements_; }

 private:
  int measurements_;
  bool moves_;
};

template <typename Kind>
std::vector<const Kind*> factors_of(const Window& window) {
  std::vector<const Kind*> found;
  for (const auto& factor : window.factors()) {
    if (const auto* kind = dynamic_cast<const Kind*>(factor.get())) found.push_back(kind);
  }
  return found;
}

/// Three keyframes, then states that are none; 0.2 s apart.
class Sliding : public testing::Test {
 protected:
  Sliding() {
    for (int i = 0; i < 4; ++i) {
      const double t = to_seconds(window_.newest().t) + kTrackedPeriod_s;
      const EstimatorInput input = world_.packet(t, kTrackedPeriod_s, false);
      WindowState state = true_state(world_, t, options_.bias_gyro, options_.bias_accel);
      state.keyframe = false;
      state.imu = input.motion.reintegrated(options_.bias_gyro, options_.bias_accel);
      state.stationary = i >= 2;
      window_.add_state(std::move(state), input.observations);
    }
    passing_ = window_.oldest_id() + 3;
  }

  const TestWorldOptions options_{.cameras = 2, .shared_ids = true, .pixel_noise = 0.1};
  TestWorld world_{options_};
  Window window_ = tracked_window(world_, options_, 3);
  StateId passing_ = 0;  ///< the oldest state that is no keyframe
};

TEST_F(Sliding, JoinsTheImuOfAStateThatIsDroppedToTheNext) {
  ASSERT_EQ(factors_of<ImuFactor>(window_).size(), 6U);
  const double strain = imu_strain(window_);
  drop_or_promote(window_, passing_, 1.0);
  EXPECT_FALSE(window_.states().contains(passing_));
  const auto imu = factors_of<ImuFactor>(window_);
  ASSERT_EQ(imu.size(), 5U);
  const std::vector<BlockKey>& joined = imu[2]->blocks();
  EXPECT_EQ(joined[0], (BlockKey{BlockKind::Pose, passing_ - 1}));
  EXPECT_EQ(joined[2], (BlockKey{BlockKind::Pose, passing_ + 1}));
  EXPECT_NEAR(window_.states().at(passing_ + 1).imu.dt(), 2 * kTrackedPeriod_s, 1e-9);
  EXPECT_NEAR(imu_strain(window_), strain, 0.3) << "the joined interval has the whole motion";
}

TEST_F(Sliding, MakesAKeyframeOfAStateBetweenLongIntervals) {
  drop_or_promote(window_, passing_, 1.5 * kTrackedPeriod_s);
  EXPECT_TRUE(window_.states().at(passing_).keyframe);
  EXPECT_EQ(factors_of<ImuFactor>(window_).size(), 6U);
}

TEST_F(Sliding, KeepsTheBeginningOfARestAndJoinsWhatIsWithinIt) {
  drop_or_promote(window_, passing_ + 1, 1.0);
  EXPECT_TRUE(window_.states().at(passing_ + 1).keyframe);
  ASSERT_EQ(factors_of<StandstillFactor>(window_).size(), 2U);
  drop_or_promote(window_, passing_ + 2, 0.1);  // at rest an interval may be longer
  EXPECT_FALSE(window_.states().contains(passing_ + 2));
  const auto rest = factors_of<StandstillFactor>(window_);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0]->blocks()[0], (BlockKey{BlockKind::Pose, passing_ + 1}));
  EXPECT_EQ(rest[0]->blocks()[1], (BlockKey{BlockKind::Pose, passing_ + 3}));
}

TEST_F(Sliding, AsksAFactorWhatBecomesOfItWhenItsStateIsDropped) {
  window_.add(std::make_shared<PositionFactor>(passing_, 1, false));
  window_.add(std::make_shared<PositionFactor>(passing_ + 1, 2, true));
  window_.add(std::make_shared<PositionFactor>(passing_ - 1, 4, true));
  EXPECT_EQ(factors_of<PositionFactor>(window_).size(), 3U);
  drop_or_promote(window_, passing_, 1.0);
  EXPECT_EQ(factors_of<PositionFactor>(window_).size(), 2U) << "one has ended";
  window_.drop_state(passing_ + 1, window_.states().at(passing_ + 1).imu.joined(window_.states().at(passing_ + 2).imu));
  const auto left = factors_of<PositionFactor>(window_);
  ASSERT_EQ(left.size(), 1U) << "two factors of one state have merged";
  EXPECT_EQ(left[0]->measurements(), 2 + 4);
}

TEST_F(Sliding, TakesFactorsOfTheMarginalisedStateIntoThePrior) {
  window_.add(std::make_shared<PositionFactor>(window_.oldest_id(), 1, true));
  window_.add(std::make_shared<PositionFactor>(window_.oldest_id() + 1, 1, true));
  const StateId next = window_.oldest_id() + 1;
  drop_oldest_keyframe(window_, {});
  ASSERT_EQ(window_.oldest_id(), next);
  const auto left = factors_of<PositionFactor>(window_);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0]->blocks().front().id, next);
  EXPECT_EQ(factors_of<ImuFactor>(window_).size(), 5U);
  const std::vector<BlockKey>& held = window_.prior()->blocks();
  EXPECT_NE(std::ranges::find(held, BlockKey{BlockKind::Motion, next}), held.end()) << "by the IMU";
  for (const BlockKey& key : held) {
    EXPECT_TRUE(key.kind != BlockKind::Pose || window_.states().at(key.id).keyframe) << key.id;
  }
}

TEST_F(Sliding, AnchorsLandmarksAnewInTheSameCameraWhereItSeesThem) {
  triangulate_features(window_, {.max_per_camera = 500});
  const ObservationKey oldest{window_.oldest_id(), 0};
  const StateId youngest = oldest.state + 2;
  std::map<FeatureId, Feature> before = window_.features();
  drop_oldest_keyframe(window_, {});
  int anew = 0;
  for (const auto& [id, feature] : window_.features()) {
    const Feature& was = before.at(id);
    if (!was.anchor || was.anchor->state != oldest.state) continue;
    ASSERT_TRUE(feature.anchor);
    ++anew;
    EXPECT_EQ(feature.anchor->state, youngest);
    EXPECT_EQ(feature.observations.begin()->first.state, youngest) << "nothing is used twice";
    const bool same = was.observations.contains({youngest, was.anchor->camera});
    EXPECT_EQ(feature.anchor->camera == was.anchor->camera, same);
  }
  EXPECT_GT(anew, 20);
  EXPECT_TRUE(solve(window_, 5).usable);
}

TEST_F(Sliding, RecordsOfAKeyframeWhatEachCameraSaw) {
  triangulate_features(window_, {.max_per_camera = 500});
  const StateId oldest = window_.oldest_id();
  std::size_t seen[2] = {0, 0};
  for (const auto& [id, feature] : window_.features()) {
    for (const std::size_t camera : {0U, 1U}) {
      seen[camera] += feature.anchor && feature.observations.contains({oldest, camera});
    }
  }
  const SE3 T_O_B = window_.states().at(oldest).T_O_B();
  const MarginalizedKeyframe record = drop_oldest_keyframe(window_, {});
  ASSERT_EQ(record.views.size(), 2U);
  for (const std::size_t camera : {0U, 1U}) {
    EXPECT_EQ(record.views[camera].points.size(), seen[camera]);
    EXPECT_GT(seen[camera], 20U);
    const SE3 T_C_O = (T_O_B * record.views[camera].T_B_C).inverse();
    for (const KeyframePoint& point : record.views[camera].points) {
      EXPECT_NEAR(point.inverse_depth * (T_C_O * world_.point_W(point.id)).z(), 1.0, 0.1);
    }
  }
}

}  // namespace
}  // namespace edged
