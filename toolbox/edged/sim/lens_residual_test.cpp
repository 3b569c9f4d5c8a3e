// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/lens_residual.hpp"

#include <gtest/gtest.h>

#include "edged/sim/renderer.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {
namespace {

constexpr int kWidth = 240, kHeight = 180;

TEST(LensResidual, IsSmoothAndHasItsRms) {
  double sum = 0.0, steepest = 0.0;
  constexpr int kSeeds = 40;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const LensResidual residual(0.2, kWidth, static_cast<std::uint64_t>(seed));
    for (int y = 0; y < kHeight; y += 10) {
      for (int x = 0; x < kWidth; x += 10) {
        const Eigen::Vector2d here = residual.at({x, y});
        sum += here.squaredNorm();
        steepest = std::max(steepest, (residual.at({x + 1.0, y}) - here).norm());
      }
    }
  }
  EXPECT_NEAR(std::sqrt(sum / (kSeeds * 18 * 24)), 0.2, 0.02);
  EXPECT_LT(steepest, 0.03) << "pixels per pixel: rays stay in order";
}

TEST(LensResidual, IsNoneWithoutOneAndAnotherForAnotherLens) {
  EXPECT_TRUE(LensResidual().at({10.0, 20.0}).isZero());
  EXPECT_TRUE(LensResidual(0.0, kWidth, 1).at({10.0, 20.0}).isZero());
  const LensResidual one(0.2, kWidth, 1), same(0.2, kWidth, 1), other(0.2, kWidth, 2);
  EXPECT_EQ(one.at({10.0, 20.0}), same.at({10.0, 20.0}));
  EXPECT_NE(one.at({10.0, 20.0}), other.at({10.0, 20.0}));
}

/// A slanted wall is as near as the displaced pixel of the calibrated lens says.
TEST(LensResidual, MovesWhatTheRendererShows) {
  const CameraModel camera = SimulatedCameraConfig().model();
  const LensResidual residual(2.0, camera.width(), 3);
  Face face;
  face.centre_W = {0.0, 0.0, 2.0};
  face.u_W = Eigen::Vector3d::UnitX(), face.v_W = Eigen::Vector3d::UnitY(), face.normal_W = -Eigen::Vector3d::UnitZ();
  face.half_u = face.half_v = 50.0;
  Scene scene;
  scene.faces.push_back(face);
  scene.textures.emplace_back(cv::Mat(64, 64, CV_8UC1, cv::Scalar(51)));
  Renderer renderer(camera, std::move(scene), residual);
  const SE3 T_W_C(so3::exp({0.2, -0.3, 0.1}), Eigen::Vector3d::Zero());
  const Rendering& picture = renderer.render(T_W_C);
  for (int y = 5; y < camera.height() - 5; y += 20) {
    for (int x = 5; x < camera.width() - 5; x += 20) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector2d point = camera.pixel_to_point(pixel + residual.at(pixel));
      const double slope = (T_W_C.rotation() * Eigen::Vector3d(point.x(), point.y(), 1.0)).z();
      EXPECT_NEAR(picture.inverse_depth[static_cast<std::size_t>(y * camera.width() + x)], slope / 2.0, 1e-6);
    }
  }
}

}  // namespace
}  // namespace edged
