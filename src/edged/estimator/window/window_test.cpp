// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The states, features, priors and terms of the window.
#include "edged/estimator/window/window.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/cost.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {
namespace {

std::size_t terms_of(const Window& window) {
  const Cost cost = cost_of(window);
  std::size_t terms = cost.factors.size();
  for (const LandmarkTerm& landmark : cost.landmarks) terms += landmark.residuals.size();
  return terms;
}

WindowState state_at(double t) {
  WindowState state;
  state.t = timestamp_from_seconds(t);
  state.keyframe = true;
  return state;
}

/// A prior on a pose, as marginalization makes it.
LinearPrior prior_of(const Window& window, BlockKey pose) {
  LinearPrior prior = gauge_prior(pose, window.states().at(pose.id).pose, 1e-3, 1e-3);
  prior.information = prior.J.transpose() * prior.J;
  return prior;
}

TEST(Window, HoldsEachTermOfTheCostOnce) {
  Tracked tracked({.cameras = 2});
  Window& window = tracked.window;
  EXPECT_EQ(terms_of(window), 3U + 1U + 5U);  // calibrations, gauge, IMU; tracks are no landmarks yet
  triangulate_features(window, {});
  std::size_t observations = 0;
  for (const auto& [id, feature] : window.features()) {
    if (feature.anchor) observations += feature.observations.size() - 1;
  }
  EXPECT_GT(observations, 100U);
  EXPECT_EQ(terms_of(window), 3U + 1U + 5U + observations);
}

TEST(Window, TakesLessOfAnErrorOnAnEventFrameForDrift) {
  Tracked tracked({.cameras = 2}, 6, {0.9, 0.6});
  Window& window = tracked.window;
  triangulate_features(window, {});
  const double decay = std::exp(-kTrackedPeriod_s / 2.0);
  for (const auto& [modality, correlation] : {std::pair(Modality::Frames, 0.9), std::pair(Modality::Events, 0.6)}) {
    const auto landmark = std::ranges::find_if(window.features(), [&, m = modality](const auto& entry) {
      return entry.second.anchor && window.cameras()[entry.second.anchor->camera].given.modality == m;
    });
    ASSERT_NE(landmark, window.features().end());
    EXPECT_NEAR(track_steps(window, landmark->second).front().correlation, correlation * decay, 1e-9);
  }
}

TEST(Window, KnowsATrackAliveThroughStatesWithoutAnImageOfItsCamera) {
  TestWorld world({.cameras = 2});
  Window window(world.rig());
  const auto add = [&](double t, std::size_t camera) { window.add_state(state_at(t), {world.observe(t, camera)}); };
  add(1.0, 0);
  const FeatureId id = window.features().begin()->first;
  add(1.05, 1);
  EXPECT_TRUE(window.alive(window.features().at(id)));
  add(3.0, 0);  // late: some have left the view
  int ended = 0;
  for (const auto& [feature_id, feature] : window.features()) ended += window.alive(feature) ? 0 : 1;
  EXPECT_GT(ended, 0);
}

TEST(Window, StrainsTheImuOnlyWhenAStateIsMovedAgainstIt) {
  Tracked tracked({.imu_noise = 0.0});
  Window& window = tracked.window;
  EXPECT_LT(imu_strain(window), 0.5);
  displace(window, window.newest_id(), {0.0, 0.0, 0.0}, {0.05, 0.0, 0.0});
  EXPECT_GT(imu_strain(window), 2.0);
}

TEST(Window, ScalesTheNoiseOfAllImuIntervals) {
  Tracked tracked, scaled({}, 3);
  scaled.window.set_imu_noise_scale(4.0);
  for (int i = 3; i < 6; ++i) {
    WindowState later = tracked.window.states().at(static_cast<StateId>(i));
    scaled.window.add_state(std::move(later));
  }
  for (Window* window : {&tracked.window, &scaled.window})
    displace(*window, window->newest_id(), {0.0, 0.0, 0.0}, {0.05, 0.0, 0.0});
  EXPECT_NEAR(imu_strain(scaled.window), imu_strain(tracked.window) / 4.0, 1e-3);
}

TEST(Window, HoldsStatesTogetherBetweenWhichTheBodyRested) {
  Tracked tracked;
  Window& window = tracked.window;
  WindowState next = window.newest();
  for (const bool rested : {false, true}) {
    const std::size_t before = terms_of(window);
    next.t += std::chrono::milliseconds(200);
    next.stationary = rested;
    window.add_state(next);
    EXPECT_EQ(terms_of(window), before + (rested ? 2 : 1));
  }
}

TEST(Window, ForgetsSoftPriorsWhoseStateHasLeft) {
  Tracked tracked;
  Window& window = tracked.window;
  EXPECT_EQ(window.soft_priors().size(), 3U);  // calibrations of camera and IMU, gauge
  window.drop_oldest({});
  ASSERT_EQ(window.soft_priors().size(), 2U);
  EXPECT_EQ(window.soft_priors().front()->blocks().front().kind, BlockKind::Calibration);
  EXPECT_EQ(window.soft_priors().back()->blocks().front().kind, BlockKind::ImuIntrinsics);
}

TEST(Window, KnowsThePoseOfTheFirstFrameCameraToTheFirstEventCamera) {
  Rig rig;
  rig.cameras = {{"events", Modality::Events, CameraModel(240, 180, 200, 200, 120, 90), SE3()},
                 {"frames", Modality::Frames, CameraModel(320, 240, 300, 300, 160, 120), SE3()}};
  rig.cameras[1].T_B_C.translation().x() = 0.05;
  Window window(rig);
  window.free_calibration({});
  const auto pair =
      std::ranges::find_if(window.soft_priors(), [](const auto& soft) { return soft->blocks().size() == 2; });
  ASSERT_NE(pair, window.soft_priors().end());
  const std::vector<BlockKey> both{{BlockKind::Calibration, 0}, {BlockKind::Calibration, 1}};
  EXPECT_EQ((*pair)->blocks(), both);
  EXPECT_EQ(window.soft_priors().size(), 4U);  // each camera, the pair, the IMU
  rig.cameras[1].T_B_C = SE3(so3::exp({0.03, 0.0, 0.0}), Eigen::Vector3d(0.0, 0.0, 1e-4));
  Window of_a_davis(rig);
  of_a_davis.free_calibration({});
  EXPECT_EQ(of_a_davis.soft_priors().size(), 3U) << "of one lens a calibration may have one rotation wrong";
}

TEST(Window, TiesTheCalibrationsOfCamerasBehindOneLens) {
  Rig rig;
  rig.cameras = {{"events", Modality::Events, CameraModel(240, 180, 200, 200, 120, 90), SE3()}};
  rig.cameras.push_back(rig.cameras.front());
  rig.cameras[1].name = "frames", rig.cameras[1].modality = Modality::Frames;
  rig.cameras.push_back(rig.cameras[1]);
  rig.cameras[2].name = "other", rig.cameras[2].T_B_C.translation().x() = 0.1;
  Window window(rig);
  window.free_calibration({});
  const auto tie =
      std::ranges::find_if(window.soft_priors(), [](const auto& soft) { return soft->blocks().size() == 2; });
  ASSERT_NE(tie, window.soft_priors().end());
  const std::vector<BlockKey> of_the_lens{{BlockKind::Calibration, 0}, {BlockKind::Calibration, 1}};
  EXPECT_EQ((*tie)->blocks(), of_the_lens);
  EXPECT_EQ(window.soft_priors().size(), 6U);  // three cameras, one tie, the frame cameras to each other, the IMU
  const auto misfit = [&](const CalibrationBlock& events, const CalibrationBlock& frames) {
    const std::array<const double*, 2> blocks{events.data(), frames.data()};
    CalibrationVector residuals;
    EXPECT_TRUE((*tie)->Evaluate(blocks.data(), residuals.data(), nullptr));
    return residuals.norm();
  };
  CalibrationBlock off{};
  for (int i = 0; i < kCalibrationSize; ++i) off[static_cast<std::size_t>(i)] = 0.01 * (i + 1);
  CalibrationBlock later = off;
  later[kTimeAt] += 0.005;
  EXPECT_NEAR(misfit(off, later), 0.0, 1e-9);
  EXPECT_GT(misfit(off, {}), 100.0);
}

TEST(Window, ComesBackFromAStepToTheBit) {
  Tracked tracked({.cameras = 2});
  Window& window = tracked.window;
  triangulate_features(window, {});
  const std::vector<double> before = window.estimates();
  for (const auto& [id, state] : window.states()) displace(window, id, {0.1, -0.2, 0.3}, {0.01, 0.02, 0.03});
  stretch_depths(window, 1.1);
  window.move(kImuIntrinsicsKey, std::vector<double>(18, 1e-3));
  EXPECT_NE(window.estimates(), before);
  window.restore(before);
  EXPECT_EQ(window.estimates(), before);
}

TEST(Window, ScalesTheNoiseOfOneCamera) {
  Tracked tracked({.cameras = 2});
  Window& window = tracked.window;
  window.rescale_noise(1, 3.0);
  for (const auto& [id, feature] : window.features()) {
    const auto& [view, observation] = *feature.observations.begin();
    EXPECT_DOUBLE_EQ(observation.sigma, (view.camera == 1 ? 3.0 : 1.0) / 200.0);
  }
  window.set_noise_scale(1, 2.0);  // of future observations
  window.add_state(state_at(3.0), {tracked.world.observe(3.0, 1)});
  int old = 0, anew = 0;
  for (const auto& [id, feature] : window.features()) {
    for (const auto& [view, observation] : feature.observations) {
      if (view.camera != 1) continue;
      EXPECT_DOUBLE_EQ(observation.sigma, (view.state == window.newest_id() ? 2.0 : 3.0) / 200.0);
      ++(view.state == window.newest_id() ? anew : old);
    }
  }
  EXPECT_GT(old, 100);
  EXPECT_GT(anew, 10);
}

/// Invariants of the window, whatever its input.
void expect_whole(const Window& window) {
  Timestamp before = Timestamp::min();
  for (const auto& [id, state] : window.states()) {
    EXPECT_LT(before, state.t);
    before = state.t;
    for (const auto& [camera, points] : state.marginalized_points) EXPECT_LT(camera, window.cameras().size());
  }
  for (const auto& [id, feature] : window.features()) {
    for (const auto& [view, seen] : feature.observations) {
      EXPECT_TRUE(window.states().contains(view.state)) << id;
      EXPECT_LT(view.camera, window.cameras().size());
      EXPECT_TRUE(feature.last_seen.contains(view.camera)) << id;
    }
    if (!feature.anchor) continue;
    ASSERT_TRUE(feature.observations.contains(*feature.anchor)) << id;
    EXPECT_TRUE(window.states().at(feature.anchor->state).keyframe) << id;
  }
  std::vector<BlockKey> held = window.prior()->blocks();
  const auto hold = [&](const auto& factors) {
    for (const auto& factor : factors) held.insert(held.end(), factor->blocks().begin(), factor->blocks().end());
  };
  hold(window.soft_priors());
  hold(window.factors());
  for (const BlockKey& key : held) EXPECT_NE(window.block(key), nullptr) << static_cast<int>(key.kind) << ' ' << key.id;
}

TEST(Window, IsWholeThroughoutAFlightWithRestAndDepths) {
  TestWorld world({.rest_s = 1.0, .cameras = 2});
  EstimatorConfig config;
  config.depth_factor.enabled = true;
  Estimator estimator(world.rig(), world.noise(), config);
  for (int i = 1; i <= 100; ++i) {
    EstimatorInput input = world.packet(0.05 * i, 0.05, i % 4 == 0);
    input.depth = RegionDepth{"frames", {-1, -1}, {1, 1}, 2.5, 0.6, 0.2};
    estimator.add(input);
    expect_whole(estimator.window());
  }
  EXPECT_FALSE(estimator.window().prior()->blocks().empty());
}

TEST(Window, HandsOnLandmarksOfItsOldestStateToANewAnchor) {
  Tracked tracked;
  Window& window = tracked.window;
  triangulate_features(window, {});
  const ObservationKey oldest{window.oldest_id(), 0}, anchor{oldest.state + 3, 0};
  std::map<FeatureId, NewAnchor> inherited;
  std::set<FeatureId> others;
  for (const auto& [id, feature] : window.features()) {
    if (feature.anchor != oldest) continue;
    if (feature.observations.contains(anchor) && inherited.size() < 10) {
      inherited.emplace(id, NewAnchor{anchor, 0.9 * feature.inverse_depth});
    } else {
      others.insert(id);
    }
  }
  ASSERT_EQ(inherited.size(), 10U);
  ASSERT_FALSE(others.empty());
  window.drop_oldest(prior_of(window, {BlockKind::Pose, anchor.state}), inherited);
  expect_whole(window);
  for (const auto& [id, anew] : inherited) {
    const Feature& feature = window.features().at(id);
    EXPECT_EQ(feature.anchor, anchor);
    EXPECT_EQ(feature.observations.begin()->first, anchor);  // nothing is used twice
    EXPECT_EQ(feature.inverse_depth, anew.inverse_depth);
  }
  for (const FeatureId id : others) EXPECT_FALSE(window.features().contains(id));
}

class WindowRefuses : public testing::Test {
 protected:
  const TestWorldOptions options_{};
  TestWorld world_{options_};
  Window window_ = tracked_window(world_, options_);
  const StateId oldest_ = window_.oldest_id(), newest_ = window_.newest_id();
  const FeatureId corner_ = window_.features().begin()->first;
};

TEST_F(WindowRefuses, AStateThatIsNoLaterThanTheNewest) {
  EXPECT_THROW(window_.add_state(window_.newest()), CheckError);
}

TEST_F(WindowRefuses, ObservationsOfACameraItDoesNotHave) {
  EXPECT_THROW(window_.add_state(state_at(9.0), {{"left", {}}}), CheckError);
  EXPECT_THROW(window_.set_depth({.camera = "left"}), CheckError);
}

TEST(Window, KeepsWhatEachCameraSeesOfAFeature) {
  TestWorld world({.cameras = 2});
  Window window(world.rig());
  const FeatureObservation left{7, {0.1, 0.0}, 0.01}, right{7, {-0.1, 0.0}, 0.01};
  const StateId first = window.add_state(state_at(1.0), {{"frames", {left}}, {"events", {right}}});
  const Feature& feature = window.features().at(7);
  EXPECT_EQ(feature.observations.at({first, 0}).point, left.point);
  EXPECT_EQ(feature.observations.at({first, 1}).point, right.point);
  window.make_landmark(7, {{first, 1}, 0.5});
  EXPECT_EQ(track_steps(window, feature).front().seen, (ObservationKey{first, 0}));
  EXPECT_THROW(window.remove_observation(7, {first, 1}), CheckError);
  window.remove_observation(7, {first, 0});
  EXPECT_TRUE(track_steps(window, feature).empty());
  window.add_state(state_at(1.1), {{"frames", {}}});
  EXPECT_FALSE(window.alive(feature, 0));
  EXPECT_TRUE(window.alive(feature));
}

TEST(Window, CorrelatesErrorsAlongTheTrackOfEachCamera) {
  Tracked tracked({.cameras = 2, .shared_ids = true}, 6, {0.9, 0.6});
  Window& window = tracked.window;
  triangulate_features(window, {});
  const double decay = std::exp(-kTrackedPeriod_s / 2.0);
  int seen_by_both = 0;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor || feature.last_seen.size() < 2) continue;
    ++seen_by_both;
    std::map<std::size_t, int> steps;
    for (const TrackStep& step : track_steps(window, feature)) {
      const bool first_of_camera = step.before.camera != step.seen.camera;
      EXPECT_EQ(first_of_camera, steps[step.seen.camera]++ == 0 && step.seen.camera != feature.anchor->camera);
      const double at_once = first_of_camera ? 0.0 : step.seen.camera == 0 ? 0.9 : 0.6;
      if (step.seen.state == step.before.state + 1) {
        EXPECT_NEAR(step.correlation, at_once * decay, 1e-9);
      }
    }
  }
  EXPECT_GT(seen_by_both, 20);
}

TEST_F(WindowRefuses, ToDropAKeyframeOrAStateAtAnEnd) {
  EXPECT_THROW(window_.drop_state(oldest_ + 1, {}), CheckError);
  WindowState last = state_at(8.0);
  last.keyframe = false;
  const StateId at_the_end = window_.add_state(std::move(last));
  EXPECT_THROW(window_.drop_state(at_the_end, {}), CheckError);
  window_.add_state(state_at(9.0));
  window_.drop_state(at_the_end, {});
  EXPECT_THROW(window_.drop_state(at_the_end, {}), CheckError);
}

TEST_F(WindowRefuses, ToDropItsOnlyState) {
  Window window(world_.rig());
  window.add_state(state_at(1.0));
  EXPECT_THROW(window.drop_oldest({}), CheckError);
}

TEST_F(WindowRefuses, AnAnchorThatDoesNotSeeTheLandmarkOrIsNoKeyframe) {
  const FeatureObservation seen{7, {0.0, 0.0}, 0.01};
  const StateId keyframe = window_.add_state(state_at(8.0), {{"frames", {seen}}});
  WindowState passing = state_at(9.0);
  passing.keyframe = false;
  const StateId other = window_.add_state(std::move(passing), {{"frames", {seen}}});
  EXPECT_THROW(window_.make_landmark(7, {{oldest_, 0}, 0.5}), CheckError);
  EXPECT_THROW(window_.make_landmark(7, {{other, 0}, 0.5}), CheckError);
  EXPECT_THROW(window_.make_landmark(8, {{keyframe, 0}, 0.5}), CheckError);
  EXPECT_THROW(window_.make_landmark(7, {{keyframe, 1}, 0.5}), CheckError);
  EXPECT_EQ(window_.block({BlockKind::InverseDepth, 7}), nullptr);
  window_.make_landmark(7, {{keyframe, 0}, 0.5});
  EXPECT_EQ(*window_.block({BlockKind::InverseDepth, 7}), 0.5);
}

TEST_F(WindowRefuses, ToForgetWhereALandmarkIsAnchored) {
  triangulate_features(window_, {});
  const auto landmark =
      std::ranges::find_if(window_.features(), [](const auto& entry) { return entry.second.anchor.has_value(); });
  ASSERT_NE(landmark, window_.features().end());
  EXPECT_THROW(window_.remove_observation(landmark->first, *landmark->second.anchor), CheckError);
}

TEST_F(WindowRefuses, PriorsOfWhatItDoesNotHold) {
  const MotionBlock mean{};
  EXPECT_THROW(window_.add_soft_prior(motion_prior({BlockKind::Motion, newest_ + 1}, mean, {1, 1, 1})), CheckError);
  EXPECT_THROW(window_.add_soft_prior(motion_prior({BlockKind::InverseDepth, corner_}, mean, {1, 1, 1})), CheckError);
  EXPECT_THROW(window_.add_soft_prior(motion_prior({BlockKind::Pose, newest_}, mean, {1, 1, 1})), CheckError);
  EXPECT_THROW(window_.drop_oldest(prior_of(window_, {BlockKind::Pose, oldest_})), CheckError);
}

TEST_F(WindowRefuses, StepsAndEstimatesOfAnotherSize) {
  EXPECT_THROW(window_.move({BlockKind::Pose, newest_ + 1}, std::vector<double>(6)), CheckError);
  EXPECT_THROW(window_.move({BlockKind::Pose, newest_}, std::vector<double>(7)), CheckError);
  std::vector<double> estimates = window_.estimates();
  estimates.pop_back();
  EXPECT_THROW(window_.restore(estimates), CheckError);
  estimates.resize(estimates.size() + 2);
  EXPECT_THROW(window_.restore(estimates), CheckError);
}

}  // namespace
}  // namespace edged
