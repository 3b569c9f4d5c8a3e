// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "edged/sim/sensors/renderer.hpp"

namespace edged {
namespace {

/// A white floor of 8 x 8 m around the origin, seen from above.
Scene floor_scene(const Lighting& lighting) {
  Face face;
  face.centre_W.setZero();
  face.u_W = Eigen::Vector3d::UnitX(), face.normal_W = Eigen::Vector3d::UnitZ();
  face.v_W = face.u_W.cross(face.normal_W);
  face.half_u = face.half_v = 4.0;
  Scene scene;
  scene.faces.push_back(face);
  scene.textures.emplace_back(cv::Mat(64, 64, CV_8UC1, cv::Scalar(255)));
  scene.lighting = lighting;
  return scene;
}

/// Looks straight down from `height`, x of the picture along x of the world.
const CameraModel kCamera(101, 81, 50, 50, 50, 40);
SE3 above(double height) { return {Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d(0, 0, height)}; }

Lamp lamp_at(const Eigen::Vector3d& centre_W) { return {centre_W, -Eigen::Vector3d::UnitZ(), 5.0, {}}; }

TEST(LampLight, FallsWithTheFourthPowerOfTheCosineOnAFloor) {
  const Lamp lamp = lamp_at({0, 0, 3});
  const double below = lamp_light(lamp, {0, 0, 0}, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(below, 5.0 / 9.0, 0.01);
  EXPECT_NEAR(lamp_light(lamp, {3, 0, 0}, Eigen::Vector3d::UnitZ()) / below, 0.25, 0.005);
  EXPECT_EQ(lamp_light(lamp, {0, 0, 0}, -Eigen::Vector3d::UnitZ()), 0.0);
  EXPECT_EQ(lamp_light(lamp, {1, 0, 4}, Eigen::Vector3d::UnitX()), 0.0);
  EXPECT_LT(lamp_light(lamp, {0, 0, 2.999}, Eigen::Vector3d::UnitZ()), 60.0);
}

TEST(LampLevel, GoesOffAndOnAgainWithinAFewHundredths) {
  Lamp lamp = lamp_at({0, 0, 3});
  lamp.switch_s = {1.0, 2.0};
  EXPECT_EQ(lamp_level(lamp, 0.5), 1.0);
  EXPECT_NEAR(lamp_level(lamp, 1.01), 0.5, 1e-9);
  EXPECT_EQ(lamp_level(lamp, 1.5), 0.0);
  EXPECT_EQ(lamp_level(lamp, 2.5), 1.0);
}

TEST(Renderer, ShowsALampsLightOnAFloorAsTheFormulaSays) {
  Lighting lighting;
  lighting.ambient = 0.2;
  lighting.lamps = {lamp_at({0.7, -0.4, 2.0}), lamp_at({-1.0, 0.0, 1.2})};
  lighting.lamps.front().switch_s = {5.0};
  Renderer renderer(kCamera, floor_scene(lighting));
  for (const double t_s : {0.0, 6.0}) {
    const Rendering& picture = renderer.render(above(2.0), t_s);
    for (int y = 4; y < 80; y += 9) {
      for (int x = 4; x < 100; x += 9) {
        const Eigen::Vector3d p_W((x - 50) * 2.0 / 50, -(y - 40) * 2.0 / 50, 0.0);
        double expected = lighting.ambient;
        for (const Lamp& lamp : lighting.lamps)
          expected += lamp_level(lamp, t_s) * lamp_light(lamp, p_W, Eigen::Vector3d::UnitZ());
        EXPECT_NEAR(picture.radiance[static_cast<std::size_t>(y * 101 + x)], expected, 0.01 * expected)
            << x << ' ' << y;
      }
    }
  }
}

TEST(Renderer, ShowsTheSunsPatchWhereTheRaysThroughTheWindowFall) {
  Lighting lighting;
  lighting.ambient = 0.1;
  lighting.sun = SunWindow{.centre_W = {0, 3, 2},
                           .u_W = Eigen::Vector3d::UnitX(),
                           .v_W = Eigen::Vector3d::UnitZ(),
                           .half_u = 0.5,
                           .half_v = 0.4,
                           .direction_W = Eigen::Vector3d(0, -1, -1).normalized(),
                           .power = 10.0};
  Renderer renderer(kCamera, floor_scene(lighting));
  const Rendering& picture = renderer.render(above(2.0));
  const auto at = [&](double x, double y) {
    const int column = 50 + static_cast<int>(std::lround(x * 25)), row = 40 - static_cast<int>(std::lround(y * 25));
    return picture.radiance[static_cast<std::size_t>(row * 101 + column)];
  };
  const double bright = 0.1 + 10.0 / std::sqrt(2.0);
  EXPECT_NEAR(at(0.0, 1.0), bright,
              0.01);  // the middle of the window, 2 m high, shines on the floor 2 m in front of the wall
  EXPECT_NEAR(at(0.4, 1.3), bright, 0.01);
  EXPECT_NEAR(at(-0.4, 0.7), bright, 0.01);
  EXPECT_NEAR(at(0.6, 1.0), 0.1, 1e-3);
  EXPECT_NEAR(at(0.0, 0.5), 0.1, 1e-3);
  EXPECT_NEAR(at(0.0, 1.5), 0.1, 1e-3);
}

TEST(Renderer, ShowsAGlowingFaceWithItsLamp) {
  Lighting lighting;
  lighting.ambient = 0.1;
  lighting.lamps = {lamp_at({0, 0, 50})};
  lighting.lamps.front().switch_s = {1.0};
  Scene scene = floor_scene(lighting);
  scene.faces.front().glows = true;
  scene.faces.front().lamp = 0;
  scene.faces.front().brightness = 3.0F;
  Renderer renderer(kCamera, scene);
  EXPECT_NEAR(renderer.render(above(2.0), 0.0).radiance[40 * 101 + 50], 3.0, 1e-3);
  EXPECT_NEAR(renderer.render(above(2.0), 2.0).radiance[40 * 101 + 50], 0.0, 1e-3);
}

/// As bright as the lobe in the middle, where the mirrored ray meets the eye, and no brighter than the matt floor
/// beyond it.
TEST(Renderer, ShowsTheLampInAGlossyFloorWhereItIsMirrored) {
  Lighting lighting;
  lighting.ambient = 0.0;
  lighting.lamps = {lamp_at({0.96, 0.0, 2.0})};
  Scene scene = floor_scene(lighting);
  const Rendering matt = Renderer(kCamera, scene).render(above(2.0));
  scene.lighting->gloss = 0.04;
  const Rendering glossy = Renderer(kCamera, scene).render(above(2.0));
  const auto gain = [&](int x) { return glossy.radiance[40 * 101 + x] / matt.radiance[40 * 101 + x] - 1.0; };
  // Camera and lamp are equally high, so that the floor mirrors the lamp half way, at x = 0.48 m.
  EXPECT_NEAR(gain(50 + 12), 0.04 * 31.0, 0.05);
  EXPECT_GT(gain(50 + 12), 2.0 * gain(50));
  EXPECT_LT(gain(0), 1e-3);
}

/// A lamp to the left of the centre: a ghost to the right, and a veil over all of the image.
TEST(Renderer, FlareOfAGlowingFaceIsAGhostAndAVeil) {
  Lighting lighting;
  lighting.ambient = 0.1;
  Scene scene = floor_scene(lighting);
  Face lamp = scene.faces.front();
  lamp.centre_W = {-0.8, 0.4, 0.01};
  lamp.half_u = lamp.half_v = 0.12;
  lamp.glows = true;
  lamp.brightness = 8.0F;
  scene.faces.push_back(lamp);
  const Rendering clear = Renderer(kCamera, scene).render(above(2.0));
  const Rendering flared = Renderer(kCamera, scene, {}, 0.05).render(above(2.0));
  const auto added = [&](int x, int y) { return flared.radiance[y * 101 + x] - clear.radiance[y * 101 + x]; };
  const auto brightest = std::ranges::max_element(clear.radiance) - clear.radiance.begin();
  const int x = static_cast<int>(brightest % 101), y = static_cast<int>(brightest / 101);
  EXPECT_NEAR(added(100 - x, 80 - y), 0.05 * 8.0, 0.02);
  EXPECT_GT(added(5, 5), 0.0);
  EXPECT_NEAR(added(5, 5), added(95, 75), 1e-5);
}

TEST(BeamLight, IsBrightestInItsMiddleAndFallsWithTheSquareOfTheDistance) {
  const Beam beam{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), 3.0, 0.0};
  const Eigen::Vector3f towards(0.0F, 0.0F, -1.0F);
  EXPECT_FLOAT_EQ(beam_light(beam, {0.0F, 0.0F, 2.0F}, towards), 3.0F);
  EXPECT_FLOAT_EQ(beam_light(beam, {0.0F, 0.0F, 4.0F}, towards), 0.75F);
  EXPECT_EQ(beam_light(beam, {0.0F, 0.0F, 2.0F}, -towards), 0.0F);
  float last = 3.0F;
  for (float x = 0.1F; x < 2.0F; x += 0.1F) {
    const float light = beam_light(beam, {x, 0.0F, 2.0F}, towards);
    EXPECT_LE(light, last) << x;
    last = light;
  }
  EXPECT_EQ(last, 0.0F);
}

TEST(BeamAt, ShinesFromItsBeginToItsEndAndTurnsNoFasterThanItSays) {
  Spotlight spot;
  spot.centre_W.setZero(), spot.axis_W = Eigen::Vector3d::UnitX();
  spot.power = 2.0, spot.begin_s = 1.0, spot.end_s = 3.0, spot.switch_s = {2.0};
  EXPECT_EQ(beam_at(spot, 0.9).power, 0.0);
  EXPECT_EQ(beam_at(spot, 1.0).power, 2.0);
  EXPECT_EQ(beam_at(spot, 2.1).power, 0.0);
  spot.switch_s.clear();
  EXPECT_EQ(beam_at(spot, 2.1).power, 2.0);
  EXPECT_EQ(beam_at(spot, 3.1).power, 0.0);
  for (double t = 1.1; t < 2.9; t += 0.05) {
    const Beam beam = beam_at(spot, t);
    const double turned = (beam_at(spot, t + 1e-4).axis - beam.axis).norm() / 1e-4;
    EXPECT_LE(turned, beam.rate + 1e-3) << t;
  }
}

TEST(MakeLighting, SwitchesItsSideLampsAtRandomTimesOfTheSeed) {
  const auto switched = [](std::uint64_t seed) {
    Random random(seed, 1);
    return make_lighting(LightingKind::Switched, {6, 6, 3}, 1.0, 30.0, random).value();
  };
  const Lighting a = switched(1), b = switched(1), c = switched(2);
  ASSERT_EQ(a.lamps.size(), 6U);
  for (std::size_t i = 2; i < 6; ++i) {
    EXPECT_GT(a.lamps[i].switch_s.size(), 5U);
    EXPECT_TRUE(std::is_sorted(a.lamps[i].switch_s.begin(), a.lamps[i].switch_s.end()));
    EXPECT_EQ(a.lamps[i].switch_s, b.lamps[i].switch_s);
    EXPECT_NE(a.lamps[i].switch_s, c.lamps[i].switch_s);
  }
  Random random(1, 1);
  EXPECT_FALSE(make_lighting(LightingKind::Even, {6, 6, 3}, 1.0, 30.0, random));
}

}  // namespace
}  // namespace edged
