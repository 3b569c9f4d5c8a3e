// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/corridor_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "edged/sim/scene/scene.hpp"

namespace edged {
namespace {

/// Three cells along x and one along y.
std::vector<SE3> path_around_a_corner() {
  std::vector<SE3> path;
  for (int i = 0; i <= 100; ++i) {
    const double s = 0.01 * i;
    path.emplace_back(Eigen::Quaterniond::Identity(),
                      Eigen::Vector3d(6.0 * std::min(2.0 * s, 1.0), std::max(0.0, 6.0 * s - 3.0), 0.0));
  }
  return path;
}

TEST(CorridorScene, HasWallsWhereThePathDoesNotLead) {
  SceneConfig config;
  config.kind = SceneKind::Corridors;
  config.wall_m = 1.5;
  config.objects = 0;
  const Scene scene = make_scene(config, path_around_a_corner(), 1);
  int walls = 0;
  std::set<std::tuple<std::size_t, float, float>> looks;
  for (const Face& face : scene.faces) {
    walls += std::abs(face.normal_W.z()) < 0.5 ? 1 : 0;
    looks.emplace(face.texture, face.offset_u, face.offset_v);
  }
  EXPECT_EQ(walls, 10);  // 4 cells, 3 of their sides inside
  EXPECT_EQ(scene.faces.size(), 18U);
  EXPECT_EQ(looks.size(), scene.faces.size()) << "no panel looks like another";
}

TEST(CorridorScene, PutsBoxesBesideThePath) {
  SceneConfig config;
  config.kind = SceneKind::Corridors;
  config.objects = 5;
  const std::size_t bare = 18;
  config.wall_m = 1.5;
  EXPECT_EQ(make_scene(config, path_around_a_corner(), 1).faces.size(), bare + 5U * 5U);
}

}  // namespace
}  // namespace edged
