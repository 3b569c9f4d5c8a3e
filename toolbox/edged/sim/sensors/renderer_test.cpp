// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/renderer.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

/// A wall that stands `distance` in front of the origin along z, seen along +z.
Scene wall_scene(double distance, double half) {
  Face face;
  face.centre_W = {0.0, 0.0, distance};
  face.u_W = Eigen::Vector3d::UnitX(), face.v_W = Eigen::Vector3d::UnitY(), face.normal_W = -Eigen::Vector3d::UnitZ();
  face.half_u = face.half_v = half;
  Scene scene;
  scene.faces.push_back(face);
  scene.textures.emplace_back(cv::Mat(64, 64, CV_8UC1, cv::Scalar(51)));
  return scene;
}

TEST(Renderer, GivesTheDepthOfASlantedPlane) {
  const CameraModel camera = SimulatedCameraConfig().model();
  Renderer renderer(camera, wall_scene(2.0, 50.0));
  const SE3 T_W_C(so3::exp({0.2, -0.3, 0.1}), Eigen::Vector3d(0.1, 0.2, -0.3));
  const Rendering& picture = renderer.render(T_W_C);
  for (int y = 0; y < camera.height(); y += 7) {
    for (int x = 0; x < camera.width(); x += 7) {
      const Eigen::Vector2d point = camera.pixel_to_point(Eigen::Vector2d(x, y));
      const double slope = (T_W_C.rotation() * Eigen::Vector3d(point.x(), point.y(), 1.0)).z();
      const std::size_t i = static_cast<std::size_t>(y * camera.width() + x);
      EXPECT_NEAR(picture.inverse_depth[i], slope / 2.3, 1e-6);
      EXPECT_NEAR(picture.radiance[i], 0.2, 1e-3);
    }
  }
}

/// A slanted wall is as near as the displaced pixel of the calibrated lens says.
TEST(Renderer, IsMovedByWhatTheModelOfTheLensLeavesOver) {
  const CameraModel camera = SimulatedCameraConfig().model();
  const LensResidual residual(2.0, camera.width(), 3);
  Renderer renderer(camera, wall_scene(2.0, 50.0), residual);
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

TEST(Renderer, ShowsTheNearerOfTwoFacesAndNothingFromBehind) {
  Scene scene = wall_scene(2.0, 50.0);
  scene.faces.push_back(wall_scene(1.0, 0.1).faces.front());
  Renderer renderer(CameraModel(64, 48, 50, 50, 31.5, 23.5), scene);
  const auto centre = [](const Rendering& picture) { return picture.inverse_depth[24 * 64 + 32]; };
  EXPECT_NEAR(centre(renderer.render(SE3())), 1.0, 1e-6);
  EXPECT_NEAR(renderer.last().inverse_depth[0], 0.5, 1e-6);
  EXPECT_EQ(centre(renderer.render(SE3(Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d(0, 0, 3)))), 0.0F);
}

TEST(Renderer, ALensThatSeesBehindItselfSeesTheWallBehindIt) {
  const CameraModel camera(96, 96, 30, 30, 48, 48, DistortionModel::Equidistant);
  Renderer renderer(camera, wall_scene(2.0, 200.0));
  const SE3 away(Eigen::Quaterniond(0, 1, 0, 0),
                 Eigen::Vector3d::Zero());  // the camera axis is along -z, away from the wall
  const Rendering& picture = renderer.render(away);
  EXPECT_EQ(picture.inverse_depth[48 * 96 + 48], 0.0F);
  const Eigen::Vector3d ray = camera.pixel_to_ray({0.0, 0.0});
  ASSERT_LT(ray.z(), -0.3);
  EXPECT_NEAR(picture.inverse_depth[0], -ray.z() / 2.0, 1e-6);
  EXPECT_NEAR(renderer.max_image_speed(Eigen::Vector3d::Zero(), {0.0, 1.0, 0.0}), 30.0, 0.1);
}

TEST(Renderer, ImageSpeedIsThatOfAPointOnTheWall) {
  Renderer renderer(CameraModel(64, 48, 50, 50, 31.5, 23.5), wall_scene(2.0, 50.0));
  renderer.render(SE3());
  EXPECT_NEAR(renderer.max_image_speed({0.4, 0.0, 0.0}, Eigen::Vector3d::Zero()), 10.0, 1e-3);
  EXPECT_NEAR(renderer.max_image_speed(Eigen::Vector3d::Zero(), {0.0, 0.0, 1.0}), std::hypot(31.5, 23.5), 1e-3);
}

/// Largest motion of any pixel from the picture at T_W_0 to that at T_W_1 [px].
double largest_motion(const CameraModel& camera, const Rendering& picture, const SE3& T_W_0, const SE3& T_W_1) {
  const SE3 T_1_0 = T_W_1.inverse() * T_W_0;
  double largest = 0.0;
  for (int y = 0; y < camera.height(); ++y) {
    for (int x = 0; x < camera.width(); ++x) {
      const Eigen::Vector2d point = camera.pixel_to_point(Eigen::Vector2d(x, y));
      const double depth = 1.0 / picture.inverse_depth[static_cast<std::size_t>(y * camera.width() + x)];
      const auto pixel = camera.project(T_1_0 * (depth * Eigen::Vector3d(point.x(), point.y(), 1.0)));
      largest = std::max(largest, (*pixel - Eigen::Vector2d(x, y)).norm());
    }
  }
  return largest;
}

TEST(Simulator, MovesNoPixelMoreThanHalfAPixelBetweenRenders) {
  SimulatorConfig config = simulator_preset("handheld-fast");
  config.duration_s = 2.5;
  config.imu.rate_hz = 5000.0;  // so that next() returns after nearly every picture
  Simulator simulator(config);
  Renderer renderer(config.camera.model(), simulator.scene());
  const auto camera_at = [&](Timestamp t) { return simulator.trajectory().at(to_seconds(t)).T_W_B * config.T_B_C; };
  double largest = 0.0;
  int looked_at = 0;
  for (;;) {
    const std::size_t count = simulator.renderings();
    const Timestamp t_0 = simulator.rendered_until();
    const bool chosen = count > 0 && count % 7 == 0;
    if (!simulator.next()) break;
    if (!chosen || simulator.renderings() != count + 1) continue;
    const Rendering& before = renderer.render(camera_at(t_0), to_seconds(t_0));
    const SE3 T_W_1 = camera_at(simulator.rendered_until());
    largest = std::max(largest, largest_motion(config.camera.model(), before, camera_at(t_0), T_W_1));
    ++looked_at;
  }
  EXPECT_GT(looked_at, 100);
  EXPECT_GT(largest, 0.4);
  EXPECT_LE(largest, 0.5);
}

}  // namespace
}  // namespace edged
