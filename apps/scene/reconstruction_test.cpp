// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Points from exact and from wrong observations. The files are read by tests/program/export_test.py.
#include "scene/reconstruction.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

/// Five images along x, that face a wall 2 m away.
class ReconstructionOfAWall : public testing::Test {
 protected:
  ReconstructionOfAWall() {
    model_.cameras.push_back({"frames", CameraModel(240, 180, 200.0, 200.0, 120.0, 90.0)});
    for (int i = 0; i < 5; ++i) {
      Reconstruction::Image& image = model_.images.emplace_back();
      image.T_W_C = SE3(so3::exp({0.0, 0.02 * i, 0.0}), {0.1 * i, 0.0, 0.0});
      for (FeatureId id = 1; id <= 12; ++id) {
        const Eigen::Vector3d p_C = image.T_W_C.inverse() * point(id);
        image.observations.push_back({id, *model_.cameras[0].pinhole.project(p_C), 77});
      }
    }
  }
  static Eigen::Vector3d point(FeatureId id) {
    return {0.1 * static_cast<double>(id % 4), 0.1 * static_cast<double>(id / 4) - 0.2, 2.0};
  }
  Reconstruction model_;
};

TEST_F(ReconstructionOfAWall, HasThePointsOfItsFeatures) {
  triangulate(model_);
  ASSERT_EQ(model_.points.size(), 12U);
  for (const Reconstruction::Point& point : model_.points) {
    const Reconstruction::Seen& seen = point.seen.front();
    const Reconstruction::Observation& observation = model_.images[seen.image].observations[seen.observation];
    EXPECT_LT((point.p_W - this->point(observation.feature)).norm(), 1e-6);
    EXPECT_EQ(point.seen.size(), 5U);
    EXPECT_LT(point.error_px, 1e-6);
    EXPECT_LT(point.towards_cameras.z(), -0.9);
    EXPECT_GT(point.covariance(2, 2), point.covariance(0, 0)) << "depth is the least certain";
    EXPECT_EQ(&model_.points[observation.point], &point);
  }
}

TEST_F(ReconstructionOfAWall, LeavesOutObservationsThatAreFarOff) {
  model_.images[3].observations[5].pixel.y() += 20.0;
  triangulate(model_);
  ASSERT_EQ(model_.points.size(), 12U);
  EXPECT_EQ(model_.images[3].observations[5].point, Reconstruction::kNone);
  EXPECT_LT((model_.points[5].p_W - point(6)).norm(), 1e-6);
}

TEST_F(ReconstructionOfAWall, HasNoPointsWithoutParallax) {
  for (Reconstruction::Image& image : model_.images) image.T_W_C = model_.images[0].T_W_C;
  for (Reconstruction::Image& image : model_.images) image.observations = model_.images[0].observations;
  triangulate(model_);
  EXPECT_TRUE(model_.points.empty());
}

}  // namespace
}  // namespace edged
