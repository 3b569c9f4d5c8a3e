// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Dense points of steps, placed in the map, and as a file.
#include "scene/dense_scan.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

const CameraModel kLens(160, 120, 140.0, 140.0, 79.5, 59.5, DistortionModel::RadTan, {-0.1, 0.01});

Rig dense_rig() {
  const SE3 T_B_C(Eigen::Quaterniond::Identity(), {0.0, 0.5, 0.0});
  return {"rig", {{"events", Modality::Events, kLens, T_B_C}, {"frames", Modality::Frames, kLens, T_B_C}}};
}

TEST(DenseInstantOfAStep, IsInTheOdometryFrameWithTheModelsOfTheImages) {
  Step step;
  step.t = Timestamp(std::chrono::seconds(3));
  step.keyframe = true;
  step.T_M_O = SE3(Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0});
  step.state.T_W_B = SE3(Eigen::Quaterniond::Identity(), {11.0, 2.0, 0.0});
  step.landmarks.push_back({1, {12.0, 0.0, 0.0}});
  step.marginalized_keyframes.push_back({step.t - std::chrono::seconds(1), step.state.T_W_B, {}});
  const cv::Mat image(120, 160, CV_8UC1, cv::Scalar(0));
  step.cameras.push_back({.name = "events", .modality = Modality::Events, .image = image});
  step.cameras.push_back({.name = "frames", .modality = Modality::Frames, .image = image});
  const DenseInstant instant = dense_instant(step, image_cameras(dense_rig()), dense_rig());
  EXPECT_TRUE(instant.keyframe);
  EXPECT_EQ(instant.T_O_B.translation(), Eigen::Vector3d(1.0, 2.0, 0.0));
  EXPECT_EQ(instant.landmarks_O.at(0), Eigen::Vector3d(2.0, 0.0, 0.0));
  EXPECT_EQ(instant.refined.at(0).T.translation(), Eigen::Vector3d(1.0, 2.0, 0.0));
  ASSERT_EQ(instant.images.size(), 2U);
  EXPECT_EQ(instant.images[0].model.distortion(), DistortionModel::None) << "event frames are undistorted";
  EXPECT_EQ(instant.images[1].model, kLens);
}

TEST(DenseScans, ArePlacedByTheFinalTrajectory) {
  const Timestamp t(std::chrono::seconds(3)), other(std::chrono::seconds(4));
  const CameraModel pinhole(160, 120, 140.0, 140.0, 79.5, 59.5);
  const DensePoint point{80, 60, 0.5F, 0.01F, 77, 5};
  const std::vector<DepthMap> maps = {{t, "frames", pinhole, {}, 1, {point}},
                                      {other, "frames", pinhole, {}, 1, {point}}};
  const std::vector<DenseScan> scans =
      place(maps, {{t, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}}}}, dense_rig());
  ASSERT_EQ(scans.size(), 1U) << "the other one has no final pose";
  EXPECT_EQ(scans[0].from_W, Eigen::Vector3d(0.0, 0.5, 1.0));
  EXPECT_NEAR((scans[0].points.at(0).p_W - Eigen::Vector3d(0.007, 0.507, 3.0)).norm(), 0.0, 1e-3);
  EXPECT_NEAR(scans[0].points[0].sigma_m, 0.04, 1e-3);
  const std::string ply = dense_ply(scans);
  const std::string end = "end_header\n";
  EXPECT_NE(ply.find("element vertex 1\n"), std::string::npos);
  EXPECT_EQ(ply.size(), ply.find(end) + end.size() + 19);
  EXPECT_EQ(ply.back(), 77);
}

}  // namespace
}  // namespace edged
