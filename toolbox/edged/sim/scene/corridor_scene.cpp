// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/corridor_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

namespace edged {
namespace {

using Cell = std::pair<int, int>;

constexpr float kTexelsAcross = 820.0F;  // of a panel

/// The plan and the heights of floor and ceiling.
struct Plan {
  std::set<Cell> cells;
  Eigen::Vector3d origin_W;  ///< centre of cell (0, 0) on the floor
  double size = 0.0, height = 0.0;

  Eigen::Vector3d centre(const Cell& cell) const {
    return origin_W + size * Eigen::Vector3d(cell.first, cell.second, 0.0);
  }
};

Plan plan_of(std::span<const SE3> path_W_C, double half_width) {
  Plan plan{.cells = {}, .origin_W = path_W_C.front().translation(), .size = 2.0 * half_width};
  double low = plan.origin_W.z(), high = low;
  for (const SE3& T_W_C : path_W_C) {
    const Eigen::Vector3d from = (T_W_C.translation() - plan.origin_W) / plan.size;
    plan.cells.emplace(static_cast<int>(std::lround(from.x())), static_cast<int>(std::lround(from.y())));
    low = std::min(low, T_W_C.translation().z()), high = std::max(high, T_W_C.translation().z());
  }
  plan.origin_W.z() = low - 0.75 * half_width;
  plan.height = high - low + 1.5 * half_width;
  return plan;
}

/// half_v: half the extent across u and the normal.
void add_panel(Scene& scene, const Eigen::Vector3d& centre_W, const Eigen::Vector3d& normal_W,
               const Eigen::Vector3d& u_W, const Eigen::Vector2d& half, double light, Random& random) {
  Face face;
  face.centre_W = centre_W;
  face.normal_W = normal_W;
  face.u_W = u_W;
  face.v_W = u_W.cross(normal_W);
  face.half_u = half.x(), face.half_v = half.y();
  const int textures = static_cast<int>(scene.textures.size()), texels = scene.textures.front().size();
  face.texture = static_cast<std::size_t>(random.index(textures));
  face.texels_per_m = kTexelsAcross / static_cast<float>(2.0 * half.x());
  face.offset_u = static_cast<float>(random.index(texels));
  face.offset_v = static_cast<float>(random.index(texels));
  face.brightness = static_cast<float>(light * random.uniform(0.6, 1.0));
  scene.faces.push_back(face);
}

void add_cell(Scene& scene, const Plan& plan, const Cell& cell, double light, Random& random) {
  const Eigen::Vector3d centre = plan.centre(cell), up = Eigen::Vector3d::UnitZ();
  const double half = 0.5 * plan.size;
  add_panel(scene, centre, up, Eigen::Vector3d::UnitX(), {half, half}, light, random);
  add_panel(scene, centre + plan.height * up, -up, Eigen::Vector3d::UnitX(), {half, half}, light, random);
  for (const auto& [x, y] : std::array<Cell, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
    if (plan.cells.contains({cell.first + x, cell.second + y})) continue;
    const Eigen::Vector3d outwards(x, y, 0.0);
    add_panel(scene, centre + half * outwards + 0.5 * plan.height * up, -outwards, up.cross(outwards),
              {half, 0.5 * plan.height}, light, random);
  }
}

bool far_from(std::span<const SE3> path_W_C, const Eigen::Vector3d& p_W, double distance) {
  return std::ranges::none_of(path_W_C, [&](const SE3& T_W_C) {
    return (T_W_C.translation() - p_W).head<2>().squaredNorm() < distance * distance;
  });
}

/// An upright box: four sides and its top.
void add_box(Scene& scene, const Eigen::Vector3d& foot_W, double yaw, const Eigen::Vector3d& half, double light,
             Random& random) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d middle_W = foot_W + half.z() * Eigen::Vector3d::UnitZ();
  for (int axis = 0; axis < 2; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d normal = side * R.col(axis);
      add_panel(scene, middle_W + half[axis] * normal, normal, Eigen::Vector3d::UnitZ().cross(normal),
                {half[1 - axis], half.z()}, light, random);
    }
  }
  add_panel(scene, middle_W + half.z() * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ(), R.col(0), half.head<2>(),
            light, random);
}

}  // namespace

void add_corridors(Scene& scene, const SceneConfig& config, std::span<const SE3> path_W_C, Random& random) {
  const Plan plan = plan_of(path_W_C, config.wall_m);
  for (const Cell& cell : plan.cells) add_cell(scene, plan, cell, config.light, random);
  const std::vector<Cell> cells(plan.cells.begin(), plan.cells.end());
  int placed = 0;
  for (int tries = 0; placed < config.objects && tries < 200 * config.objects; ++tries) {
    const double scale = config.wall_m / 1.6;
    const double a = random.uniform(0.12, 0.3), b = random.uniform(0.12, 0.3), c = random.uniform(0.15, 0.6);
    const Eigen::Vector3d half = scale * Eigen::Vector3d(a, b, c);
    const double reach = half.head<2>().norm(), free = config.wall_m - reach;
    const Cell cell = cells[static_cast<std::size_t>(random.index(static_cast<int>(cells.size())))];
    const double x = random.uniform(-free, free), y = random.uniform(-free, free);
    const double yaw = random.uniform(0.0, std::numbers::pi);
    const Eigen::Vector3d foot_W = plan.centre(cell) + Eigen::Vector3d(x, y, 0.0);
    if (!far_from(path_W_C, foot_W, config.clearance_m + reach)) continue;
    add_box(scene, foot_W, yaw, half, config.light, random);
    ++placed;
  }
}

}  // namespace edged
