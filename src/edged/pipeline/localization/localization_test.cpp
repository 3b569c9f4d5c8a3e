// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Localization without images: exact observations and IMU of a known motion.
#include "edged/pipeline/localization/localization.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "edged/core/check.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

class LocalizationInTheTestWorld : public testing::Test {
 protected:
  /// One packet; seen: false: without observations.
  LocalizationOutput step(bool seen = true) {
    ++packet_;
    EstimatorInput input = world_.packet(t(), kPacket_s, packet_ % 4 == 0);
    VisionOutput vision;
    vision.images.push_back({.camera = "frames", .model = world_.rig().cameras.front().model});
    vision.observations = std::move(input.observations);
    if (!seen) vision.observations.front().features.clear();
    vision.keyframe = input.keyframe;
    vision.scene_depth = 2.5;
    return localization_.process(localization_.predict(input.motion.samples()), vision);
  }
  LocalizationOutput run(double duration_s) {
    LocalizationOutput output = step();
    while (t() < duration_s) output = step();
    return output;
  }
  double t() const { return kPacket_s * packet_; }

  TestWorld world_{TestWorldOptions{}};
  StageTimings timings_;
  Localization localization_{world_.rig(), world_.noise(), {}, timings_};
  int packet_ = 0;
};

TEST_F(LocalizationInTheTestWorld, EstimatesTheMotionFromObservationsAndImu) {
  EXPECT_EQ(step().step.status, TrackingStatus::Initializing);
  const LocalizationOutput early = run(4.0);
  ASSERT_EQ(early.step.status, TrackingStatus::Good);
  const SE3 then = world_.T_W_B(t());
  const LocalizationOutput late = run(6.0);
  const SE3 estimated = early.step.state.T_W_B.inverse() * late.step.state.T_W_B;
  const SE3 true_motion = then.inverse() * world_.T_W_B(t());
  EXPECT_LT((estimated.translation() - true_motion.translation()).norm(), 0.05);
  EXPECT_LT(so3::log(estimated.rotation().conjugate() * true_motion.rotation()).norm(), 0.02);
  EXPECT_TRUE(late.step.covariance);
  EXPECT_EQ(late.step.t, timestamp_from_seconds(t()));
  EXPECT_EQ(late.step.scene_depth, 2.5);
}

TEST_F(LocalizationInTheTestWorld, TellsVisionTheDepthsOfLandmarks) {
  EXPECT_FALSE(step().correction.landmarks) << "there is no estimate yet";
  const LocalizationOutput output = run(4.0);
  EXPECT_FALSE(output.correction.provisional);
  ASSERT_TRUE(output.correction.landmarks);
  ASSERT_GT(output.correction.landmarks->front().size(), 30U);
  const SE3 T_C_W = (world_.T_W_B(t()) * world_.rig().cameras.front().T_B_C).inverse();
  int all = 0, right = 0;
  for (const Landmark& landmark : output.step.landmarks) {
    const auto depth = output.correction.landmarks->front().find(landmark.id);
    if (depth == output.correction.landmarks->front().end()) continue;
    const double truth = (T_C_W * world_.point_W(landmark.id)).z();
    right += std::abs(depth->second - truth) < 0.2 * truth ? 1 : 0;
    ++all;
  }
  EXPECT_GT(right, 0.9 * all) << "the youngest are uncertain";
}

TEST_F(LocalizationInTheTestWorld, GivesStatesInTheMapFrame) {
  const LocalizationOutput output = run(4.0);
  const SE3 T_M_B = output.step.T_M_O * localization_.body().now().T_O_B;
  EXPECT_LT((T_M_B.translation() - output.step.state.T_W_B.translation()).norm(), 1e-12);
}

TEST_F(LocalizationInTheTestWorld, IsLostWithoutObservationsAndGoesOnWhereItWas) {
  run(4.0);
  LocalizationOutput output = step(false);
  for (int i = 0; i < 100 && output.step.status != TrackingStatus::Lost; ++i) output = step(false);
  ASSERT_EQ(output.step.status, TrackingStatus::Lost);
  EXPECT_TRUE(output.correction.ended);
  EXPECT_TRUE(output.correction.provisional);
  EXPECT_FALSE(output.step.lost_because.empty());
  const Eigen::Vector3d lost_at = output.step.state.T_W_B.translation(), true_then = world_.T_W_B(t()).translation();
  for (int i = 0; i < 120 && output.step.started.empty(); ++i) output = step();
  ASSERT_FALSE(output.step.started.empty());
  EXPECT_TRUE(output.correction.T_new_old);
  const double moved = (world_.T_W_B(t()).translation() - true_then).norm();
  EXPECT_LT((output.step.state.T_W_B.translation() - lost_at).norm(), moved + 1.0);
}

TEST_F(LocalizationInTheTestWorld, EndsTheEstimateWhenAClockWasSetBackButKeepsThePath) {
  run(4.0);
  const std::size_t poses = localization_.final_trajectory().poses.size();
  EXPECT_GT(poses, 10U);
  localization_.begin_epoch();
  EXPECT_EQ(localization_.final_trajectory().poses.size(), poses);
  EXPECT_FALSE(localization_.calibration_covariance("frames"));
  const LocalizationOutput output = step();
  EXPECT_EQ(output.step.status, TrackingStatus::Lost);
  EXPECT_EQ(output.step.lost_because, "a clock was set back");
}

TEST_F(LocalizationInTheTestWorld, HasNoPoseWithoutAMapIfItOnlyLocalizes) {
  OdometryConfig config;
  config.map.localize_only = true;
  localization_ = Localization(world_.rig(), world_.noise(), config, timings_);
  for (LocalizationOutput output = step(); t() < 4.0; output = step()) {
    EXPECT_EQ(output.step.status, TrackingStatus::Initializing);
    EXPECT_TRUE(output.step.landmarks.empty());
  }
  const LocalizationOutput output = step();
  EXPECT_FALSE(output.correction.ended) << "the odometry goes on";
  EXPECT_EQ(output.step.waiting_for.substr(0, 23), "localization in the map");
  EXPECT_TRUE(localization_.final_trajectory().poses.empty());
}

TEST_F(LocalizationInTheTestWorld, TakesNoMapAfterTheFirstPose) {
  run(4.0);
  EXPECT_THROW(localization_.load_map(""), InputError);
}

}  // namespace
}  // namespace edged
