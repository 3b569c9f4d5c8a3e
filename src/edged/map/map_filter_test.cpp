// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The filter with odometry that drifts by a known random walk, in a world of known points.
#include "edged/map/map_filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace edged {
namespace {

constexpr double kStep_s = 0.25, kPixel = 1.0 / 200.0;

/// A body that circles in front of a wall of points in view, and odometry that drifts in position and yaw. Gravity
/// holds its tilt, with an error that changes slowly.
class World {
 public:
  explicit World(std::uint64_t seed, double drift_m = 0.002, double drift_rad = 0.001)
      : random_(seed), drift_m_(drift_m), drift_rad_(drift_rad) {
    std::uniform_real_distribution<double> wide(-2.0, 2.0), deep(2.5, 4.0);
    for (int i = 0; i < 60; ++i) points_.emplace_back(deep(random_), wide(random_), wide(random_));
    level_ = truth(0.0);
  }

  /// Periodic, every 8 s. The camera axis is along x, z of the camera.
  static SE3 truth(double t) {
    const double a = 2.0 * M_PI * t / 8.0;
    return {so3::exp({0.0, 0.05 * std::sin(a), 0.1 * std::cos(a)}),
            {0.3 * std::cos(2.0 * a), 0.6 * std::sin(a), 0.3 * std::cos(a)}};
  }
  const SE3 T_B_C = SE3(Eigen::Quaterniond(Eigen::Matrix3d{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}), {0.05, 0.0, 0.02});

  /// T_O_B a step later.
  SE3 odometry(double t) {
    const SE3 moved = truth(t - kStep_s).inverse() * truth(t);
    const double root = std::sqrt(kStep_s), tilt_kept = std::exp(-kStep_s / kTilt_s);
    const Eigen::Vector3d position = drift_m_ * root * normal(), turn = drift_rad_ * root * normal();
    const SE3 next = level_ * moved;
    level_ = {so3::exp({0.0, 0.0, turn.z()}) * next.rotation(), next.translation() + next.R() * position};
    tilt_ = tilt_kept * tilt_ + drift_rad_ * std::sqrt(0.5 * kTilt_s * (1.0 - tilt_kept * tilt_kept)) * normal();
    return {so3::exp({tilt_.x(), tilt_.y(), 0.0}) * level_.rotation(), level_.translation()};
  }

  /// Every third point of that keyframe, observed from the true pose at t with that noise.
  std::vector<MapObservation> observations(const std::vector<SE3>& keyframes, std::size_t keyframe, double t,
                                           double noise_px = 0.4) {
    std::vector<MapObservation> out;
    for (std::size_t i = keyframe % 3; i < points_.size(); i += 3) {
      const Eigen::Vector3d p_C = (truth(t) * T_B_C).inverse() * points_[i];
      const Eigen::Vector2d noise = noise_px * kPixel * normal().head<2>();
      out.push_back({static_cast<std::uint32_t>(keyframe), keyframes[keyframe].inverse() * points_[i],
                     Eigen::Vector3d::Zero(), p_C.hnormalized() + noise, 0.4 * kPixel});
    }
    return out;
  }

  Eigen::Vector3d normal() {
    std::normal_distribution<double> one;
    return {one(random_), one(random_), one(random_)};
  }

 private:
  std::mt19937_64 random_;
  static constexpr double kTilt_s = 10.0;  // of its error, which changes as fast as yaw drifts
  double drift_m_, drift_rad_;
  std::vector<Eigen::Vector3d> points_;
  SE3 level_;  // T_O_B without the error of its tilt
  Eigen::Vector3d tilt_ = Eigen::Vector3d::Zero();
};

constexpr Drift kDriftOfWorld = {0.002, 0.001, 0.001};

/// RMS errors over the times of a random walk, and the mean NEES over six.
struct Walk {
  double early_m = 0.0, late_m = 0.0, odometry_late_m = 0.0, nees = 0.0;
};

/// Keyframes in the first round, of 8 s; after that their points are observed again. At most so many are active.
Walk walk(std::uint64_t seed, int max_active = 100) {
  constexpr double kMapped_s = 8.0, kEarly_s = 60.0, kLate_s = 180.0, kEnd_s = 240.0;
  World world(seed);
  MapFilter filter(MapFilterConfig(), false, max_active);
  filter.restart(SE3(), World::truth(0.0), Timestamp{}, 0.0, 0.0);
  SE3 T_M_O;
  std::vector<SE3> keyframes;  // their true poses
  Walk sum;
  int early = 0, late = 0, all = 0;
  for (double t = kStep_s; t < kEnd_s; t += kStep_s) {
    const SE3 T_O_B = world.odometry(t), T_M_B = World::truth(t);
    filter.predict(T_M_O, T_O_B, timestamp_from_seconds(t), kDriftOfWorld);
    const auto nth = static_cast<std::size_t>(std::lround(t / kStep_s));
    if (t <= kMapped_s) {
      if (nth % 4 != 0) continue;
      filter.add_keyframe(T_M_O, T_O_B, timestamp_from_seconds(t));
      keyframes.push_back(T_M_B);
      continue;
    }
    const std::vector<MapObservation> observations = world.observations(keyframes, nth / 4 % keyframes.size(), t);
    filter.activate(std::array{observations.front().keyframe});
    T_M_O = filter.update(observations, observations.size(), {world.T_B_C}).value_or(T_M_O);
    Eigen::Matrix<double, 6, 1> error;
    error << T_M_B.translation() - filter.T_M_B().translation(),
        so3::log((filter.T_M_B().inverse() * T_M_B).rotation());
    sum.nees += error.dot(filter.covariance().ldlt().solve(error)) / 6.0;
    ++all;
    if (t < kEarly_s) sum.early_m += error.head<3>().squaredNorm(), ++early;
    if (t < kLate_s) continue;
    sum.late_m += error.head<3>().squaredNorm();
    sum.odometry_late_m += (T_O_B.translation() - T_M_B.translation()).squaredNorm();
    ++late;
  }
  return {std::sqrt(sum.early_m / early), std::sqrt(sum.late_m / late), std::sqrt(sum.odometry_late_m / late),
          sum.nees / all};
}

Walk mean_of_walks(int max_active) {
  Walk mean;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Walk walked = walk(seed, max_active);
    mean.early_m += walked.early_m / 12.0;
    mean.late_m += walked.late_m / 12.0;
    mean.odometry_late_m += walked.odometry_late_m / 12.0;
    mean.nees += walked.nees / 12.0;
  }
  return mean;
}

TEST(MapFilter, HoldsTheBodyWhereTheOdometryWalksAwayAndKnowsHowWell) {
  const Walk mean = mean_of_walks(100);
  EXPECT_LT(mean.late_m, 1.1 * mean.early_m) << "the drift of the first round remains, no more";
  EXPECT_LT(mean.late_m, 0.4 * mean.odometry_late_m);
  EXPECT_GT(mean.nees, 0.6);
  EXPECT_LT(mean.nees, 1.5);
}

/// Four of eight keyframes are active, and each comes back once a round, 29 times.
TEST(MapFilter, IsAsGoodAndAsSureWhereMostKeyframesAreInactive) {
  const Walk full = mean_of_walks(100), mean = mean_of_walks(4);

  EXPECT_LT(mean.late_m, 1.1 * full.late_m);
  EXPECT_GT(mean.nees, 0.6);
  EXPECT_LT(mean.nees, 1.15);
}

class OneKeyframe : public testing::Test {
 protected:
  OneKeyframe() : world_(3), filter_(MapFilterConfig()) {
    filter_.restart(SE3(), World::truth(0.0), Timestamp{}, 0.0, 0.0);
    filter_.add_keyframe(SE3(), World::truth(0.0), Timestamp{});
    const SE3 off(so3::exp({0.0, 0.0, 0.004}), {0.01, -0.006, 0.004});
    T_O_B_ = off * World::truth(4.0);
    filter_.predict(SE3(), T_O_B_, timestamp_from_seconds(4.0), kDriftOfWorld);
    sights_ = world_.observations({World::truth(0.0)}, 0, 4.0, 0.0);
  }
  double error() const { return (filter_.T_M_B().translation() - World::truth(4.0).translation()).norm(); }

  World world_;
  MapFilter filter_;
  SE3 T_O_B_;
  std::vector<MapObservation> sights_;
};

TEST_F(OneKeyframe, PullsTheBodyBack) {
  const double before = error();
  ASSERT_TRUE(filter_.update(sights_, sights_.size(), {world_.T_B_C}));
  EXPECT_LT(error(), 0.6 * before);
}

TEST_F(OneKeyframe, ChangesNothingWhereTooFewOrTooSmallAShareIsFound) {
  const SE3 before = filter_.T_M_B();
  EXPECT_FALSE(filter_.update(std::span(sights_).first(5), 5, {world_.T_B_C}));
  EXPECT_FALSE(filter_.update(sights_, 3 * sights_.size(), {world_.T_B_C}));
  EXPECT_EQ(before.translation(), filter_.T_M_B().translation());
}

TEST_F(OneKeyframe, ChangesNothingWhereTheSightsAgreeOnNoPose) {
  const SE3 before = filter_.T_M_B();
  for (MapObservation& observation : sights_) observation.seen += 8.0 * kPixel * world_.normal().head<2>();
  EXPECT_FALSE(filter_.update(sights_, sights_.size(), {world_.T_B_C}));
  EXPECT_EQ(before.translation(), filter_.T_M_B().translation());
}

TEST_F(OneKeyframe, IsHardlyMovedByAFewThatAreWrong) {
  for (std::size_t i = 0; i < sights_.size(); i += 5) sights_[i].seen.x() += 12.0 * kPixel;
  const double before = error();
  ASSERT_TRUE(filter_.update(sights_, sights_.size(), {world_.T_B_C}));
  EXPECT_LT(error(), 0.6 * before);
}

TEST_F(OneKeyframe, NeverTakesAPointThatLiesBehind) {
  sights_[0].p_K = Eigen::Vector3d(-5.0, 0.0, 0.0);
  EXPECT_FALSE(filter_.update(sights_, sights_.size(), {world_.T_B_C}));
}

/// The predicted error of an observation follows from the Jacobians of both poses: once with an exact keyframe, once
/// with an exact body.
TEST_F(OneKeyframe, ExpectsSightsAsFarOffAsTheBodyIsUncertain) {
  filter_.restart(SE3(), World::truth(4.0), timestamp_from_seconds(4.0), 0.1, 0.0);
  double sum = 0.0;
  for (const MapObservation& observation : sights_) {
    const double z = 1.0 / (kPixel * 200.0) *
                     ((World::truth(4.0) * world_.T_B_C).inverse() * (World::truth(0.0) * observation.p_K)).z();
    sum += filter_.expected_error(observation, world_.T_B_C) * z / (0.1 * std::sqrt(2.0));
  }
  EXPECT_NEAR(sum / static_cast<double>(sights_.size()), 1.0, 0.15);  // off the axis z counts, too
}

TEST_F(OneKeyframe, ForgetsAKeyframeAndKeepsTheOthers) {
  filter_.add_keyframe(SE3(), T_O_B_, timestamp_from_seconds(4.0));
  const SE3 kept = filter_.keyframes()[1];
  filter_.remove_keyframe(0);
  ASSERT_EQ(filter_.keyframes().size(), 1U);
  EXPECT_EQ(filter_.keyframes()[0].translation(), kept.translation());
  const std::vector<MapObservation> observations = world_.observations({World::truth(4.0)}, 0, 4.0, 0.0);
  EXPECT_TRUE(filter_.update(observations, observations.size(), {world_.T_B_C}));
}

TEST(MapFilter, LeavesFixedKeyframesAsTheyAreAndTheBodyAsUncertainAsWithThem) {
  const std::vector<SE3> keyframes = {World::truth(0.0), World::truth(1.0)};
  const Eigen::MatrixXd covariance = 1e-4 * Eigen::MatrixXd::Identity(12, 12);
  MapFilter moving{MapFilterConfig()}, fixed{MapFilterConfig(), true};
  for (MapFilter* filter : {&moving, &fixed}) {
    World world(3);
    filter->load(keyframes, covariance);
    filter->restart(SE3(), World::truth(4.0) * SE3(so3::exp({0.0, 0.0, 0.01}), {0.02, 0.0, 0.01}),
                    timestamp_from_seconds(4.0), 0.1, 0.05);
    const std::vector<MapObservation> observations = world.observations(keyframes, 1, 4.0, 0.2);
    ASSERT_TRUE(filter->update(observations, observations.size(), {world.T_B_C}));
  }
  EXPECT_NE(moving.keyframes()[1].translation(), keyframes[1].translation());
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(fixed.keyframes()[k].matrix(), keyframes[k].matrix());
  EXPECT_EQ(fixed.keyframe_covariance(), covariance);
  EXPECT_EQ(fixed.T_M_B().matrix(), moving.T_M_B().matrix());
  EXPECT_EQ(fixed.covariance(), moving.covariance());
}

/// A camera that points backwards adds what the first cannot separate: movement to the side and rotation.
TEST(MapFilter, TakesEachObservationByTheCameraOfItsImage) {
  const SE3 front = World(1).T_B_C, rear = SE3(so3::exp({0.0, 0.0, M_PI}), Eigen::Vector3d::Zero()) * front;
  const SE3 T_M_B(so3::exp({0.0, 0.0, 0.02}), {0.0, 0.05, 0.0});
  const auto error_with = [&](bool both) {
    MapFilter filter{MapFilterConfig()};
    filter.restart(SE3(), SE3(), Timestamp{}, 0.0, 0.0);
    filter.add_keyframe(SE3(), SE3(), Timestamp{});
    filter.restart(SE3(), SE3(), Timestamp{}, 0.1, 0.05);
    std::vector<MapObservation> observations;
    for (int i = 0; i < (both ? 24 : 12); ++i) {
      const std::uint32_t camera = i % (both ? 2 : 1);
      const Eigen::Vector3d p_M((camera == 0 ? 3.0 : -3.0), 0.2 * (i % 5) - 0.4, 0.2 * (i % 3) - 0.2);
      const Eigen::Vector3d p_C = (T_M_B * (camera == 0 ? front : rear)).inverse() * p_M;
      observations.push_back({0, p_M, Eigen::Vector3d::Zero(), p_C.hnormalized(), 0.002, camera});
    }
    EXPECT_TRUE(filter.update(observations, observations.size(), {front, rear}));
    return (filter.T_M_B().translation() - T_M_B.translation()).norm();
  };
  EXPECT_LT(error_with(true), 0.002);
  EXPECT_LT(error_with(true), 0.2 * error_with(false));
}

/// A street is walked along, then the first keyframe is observed from its end: of a chain, nothing is lost.
TEST(MapFilter, ClosesALoopAsTheFullFilterDoes) {
  constexpr int kKeyframes = 12;
  std::vector<MapFilter> filters;
  for (const int max_active : {100, 3}) {
    World world(5, 0.005, 0.001);
    constexpr Drift kDrift = {0.005, 0.001, 0.001};
    MapFilter& filter = filters.emplace_back(MapFilterConfig(), false, max_active);
    filter.restart(SE3(), World::truth(0.0), Timestamp{}, 0.1, 0.01);
    std::vector<SE3> keyframes;
    for (int k = 1; k <= kKeyframes; ++k) {
      const Timestamp t = timestamp_from_seconds(kStep_s * k);
      const SE3 T_O_B = world.odometry(kStep_s * k);
      filter.predict(SE3(), T_O_B, t, kDrift);
      filter.add_keyframe(SE3(), T_O_B, t);
      keyframes.push_back(World::truth(kStep_s * k));
    }
    EXPECT_EQ(filter.inactive().size(), max_active == 3 ? kKeyframes - 4U : 0U);
    SE3 T_M_O;
    for (const std::uint32_t keyframe : {2U, 0U}) {
      const std::vector<MapObservation> observations =
          world.observations(keyframes, keyframe, kStep_s * kKeyframes, 0.2);
      filter.activate(std::array{keyframe});
      const auto corrected = filter.update(observations, observations.size(), {world.T_B_C});
      ASSERT_TRUE(corrected);
      T_M_O = *corrected;
      filter.predict(T_M_O, T_M_O.inverse() * filter.T_M_B(), timestamp_from_seconds(kStep_s * kKeyframes), kDrift);
    }
  }
  MapFilter &full = filters[0], &few = filters[1];
  for (std::size_t k = 0; k < kKeyframes; ++k)
    EXPECT_LT((full.keyframes()[k].inverse() * few.keyframes()[k]).log().norm(), 1e-5) << k;
  std::vector<std::uint32_t> all(kKeyframes);
  std::iota(all.begin(), all.end(), 0U);
  few.activate(all);
  EXPECT_LT((full.keyframe_covariance() - few.keyframe_covariance()).norm(), 1e-3 * full.keyframe_covariance().norm());
}

TEST(MapFilter, RemovesAKeyframeThatIsAParentOfOthers) {
  MapFilter filter{MapFilterConfig(), false, 3}, full{MapFilterConfig()};
  for (MapFilter* each : {&filter, &full}) {
    World world(7);
    each->restart(SE3(), World::truth(0.0), Timestamp{}, 0.1, 0.01);
    for (int k = 1; k <= 10; ++k) {
      const SE3 T_O_B = world.odometry(kStep_s * k);
      each->predict(SE3(), T_O_B, timestamp_from_seconds(kStep_s * k), kDriftOfWorld);
      each->add_keyframe(SE3(), T_O_B, timestamp_from_seconds(kStep_s * k));
    }
    for (const std::size_t keyframe : {8U, 3U, 0U}) each->remove_keyframe(keyframe);  // active, inactive, inactive
  }
  ASSERT_EQ(filter.keyframes().size(), 7U);
  filter.activate(std::array{0U, 1U, 2U, 3U, 4U, 5U, 6U});
  EXPECT_TRUE(filter.inactive().empty());
  EXPECT_LT((full.keyframe_covariance() - filter.keyframe_covariance()).norm(),
            1e-3 * full.keyframe_covariance().norm());
}

TEST(MapFilter, KeepsTheTiltOfTheOdometryWhereEachMatchTurnsItALittle) {
  // Points 1 s old, in view from 0.5 m farther on, always 0.1 deg off in roll.
  const SE3 T_B_C(Eigen::Quaterniond(Eigen::Matrix3d{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}), Eigen::Vector3d::Zero());
  const Eigen::Quaterniond roll = so3::exp({0.1 * M_PI / 180.0, 0.0, 0.0});
  MapFilter filter{MapFilterConfig()};
  filter.restart(SE3(), SE3(), Timestamp{}, 0.0, 0.0);
  SE3 T_M_O;
  for (int k = 0; k < 120; ++k) {
    const SE3 T_O_B(Eigen::Quaterniond::Identity(), {0.5 * k, 0.0, 0.0});
    filter.predict(T_M_O, T_O_B, timestamp_from_seconds(k), {0.002, 0.0035, 0.007});
    std::vector<MapObservation> observations;
    for (int i = 0; k > 0 && i < 25; ++i) {
      const Eigen::Vector3d p_K(3.0 + i % 3, 0.7 * (i % 5 - 2), 0.6 * (i / 5 - 2));
      const Eigen::Vector3d p_C = T_B_C.inverse() * (roll * (p_K - Eigen::Vector3d(0.5, 0.0, 0.0)));
      const auto last = static_cast<std::uint32_t>(k - 1);
      observations.push_back({last, p_K, Eigen::Vector3d::Zero(), p_C.hnormalized(), 0.002});
    }
    T_M_O = filter.update(observations, observations.size(), {T_B_C}).value_or(T_M_O);
    filter.add_keyframe(T_M_O, T_O_B, timestamp_from_seconds(k));
  }
  EXPECT_GT(so3::log(T_M_O.rotation()).norm(), 0.1 * M_PI / 180.0) << "the matches count";
  EXPECT_LT(std::acos(T_M_O.R()(2, 2)), 2.0 * M_PI / 180.0) << "11.7 deg without gravity";
}

/// Body and keyframe were placed with the tilt of the start; then the odometry learns its tilt, and turns.
TEST(MapFilter, TurnsTheWholeMapAsTheOdometryLearnsItsTilt) {
  constexpr double kBefore_rad = 0.03, kNow_rad = 0.002;
  const auto turn_after = [](double sigma_before, double sigma_now, double learned_rad) {
    World world(3);
    MapFilter filter{MapFilterConfig()};
    filter.restart(SE3(), World::truth(0.0), Timestamp{}, 0.0, 0.0, sigma_before);
    filter.add_keyframe(SE3(), World::truth(0.0), Timestamp{});
    filter.predict(SE3(), SE3(so3::exp({0.0, learned_rad, 0.0}), Eigen::Vector3d::Zero()) * World::truth(4.0),
                   timestamp_from_seconds(4.0), kDriftOfWorld);
    filter.set_tilt_sigma(sigma_now);
    const auto observations = world.observations({World::truth(0.0)}, 0, 4.0, 0.0);
    EXPECT_TRUE(filter.update(observations, observations.size(), {world.T_B_C}));
    const SE3 T_K_B = filter.keyframes().front().inverse() * filter.T_M_B();
    EXPECT_LT((World::truth(0.0) * T_K_B * World::truth(4.0).inverse()).translation().norm(), 0.02);
    return so3::log((filter.keyframes().front() * World::truth(0.0).inverse()).rotation()).y();
  };
  EXPECT_NEAR(turn_after(kBefore_rad, kNow_rad, -kBefore_rad), -kBefore_rad, 0.2 * kBefore_rad);
  EXPECT_NEAR(turn_after(kNow_rad, kNow_rad, -0.2 * kBefore_rad), 0.0, 0.1 * kBefore_rad) << "it was known";
}

/// A step to the side and a turn move the points of an image alike.
TEST(MapFilter, MovesABodyWhoseVelocityIsUncertainAndDoesNotTurnIt) {
  World world(3);
  MapFilter filter{MapFilterConfig()};
  filter.restart(SE3(), World::truth(0.0), Timestamp{}, 0.0, 0.0);
  filter.add_keyframe(SE3(), World::truth(0.0), Timestamp{});
  const SE3 drifted(World::truth(4.0).rotation(), World::truth(4.0).translation() + Eigen::Vector3d(0.0, 0.03, 0.0));
  filter.predict(SE3(), drifted, timestamp_from_seconds(4.0), drift_of({.velocity = 0.03, .gyro_bias = 5e-5}));
  const auto observations = world.observations({World::truth(0.0)}, 0, 4.0, 0.0);
  ASSERT_TRUE(filter.update(observations, observations.size(), {world.T_B_C}));
  const SE3 error = World::truth(4.0).inverse() * filter.T_M_B();
  EXPECT_LT(error.translation().norm(), 0.003);
  EXPECT_LT(so3::log(error.rotation()).norm(), 0.0005);
}

TEST(MapFilter, IsLessSureOfAnOdometryThatDriftsMore) {
  const auto variance_after = [](double sigma) {
    MapFilter filter{MapFilterConfig()};
    filter.restart(SE3(), SE3(), Timestamp{}, 0.0, 0.0);
    filter.predict(SE3(), SE3(), timestamp_from_seconds(1.0), drift_of({.velocity = sigma, .gyro_bias = 0.1 * sigma}));
    return filter.covariance().trace();
  };
  EXPECT_NEAR(variance_after(5e-3), 25.0 * variance_after(1e-3), 1e-12);
}

}  // namespace
}  // namespace edged
