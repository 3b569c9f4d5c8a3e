// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/light_field.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr double kPitch_m = 0.025;
// A face lies in front of its support, so that a lamp in the plane of the support gives no light by rounding errors.
constexpr double kLift_m = 1e-6;

}  // namespace

LightField::LightField(const Scene& scene) {
  if (!scene.lighting) return;
  lamps_ = scene.lighting->lamps;
  levels_ = levels_at(0.0);
  for (const Face& face : scene.faces) {
    maps_.push_back(make_map(face, *scene.lighting));
    add_up(maps_.back());
  }
}

LightField::Map LightField::make_map(const Face& face, const Lighting& lighting) {
  Map map;
  map.lamp = face.lamp;
  if (face.glows) return map;
  map.columns = 2 + static_cast<int>(2.0 * face.half_u / kPitch_m);
  map.rows = 2 + static_cast<int>(2.0 * face.half_v / kPitch_m);
  map.middle_u = 0.5F * static_cast<float>(map.columns - 1);
  map.middle_v = 0.5F * static_cast<float>(map.rows - 1);
  map.per_m_u = map.middle_u / static_cast<float>(face.half_u);
  map.per_m_v = map.middle_v / static_cast<float>(face.half_v);
  // Coordinates stay below the last node, so that each has a next node for the interpolation.
  map.last_u = std::nextafter(static_cast<float>(map.columns - 1), 0.0F);
  map.last_v = std::nextafter(static_cast<float>(map.rows - 1), 0.0F);
  std::vector<Eigen::Vector3d> nodes_W;
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.columns; ++x) {
      const double u = face.half_u * (2.0 * x / (map.columns - 1) - 1.0);
      const double v = face.half_v * (2.0 * y / (map.rows - 1) - 1.0);
      nodes_W.push_back(face.centre_W + u * face.u_W + v * face.v_W + kLift_m * face.normal_W);
    }
  }
  for (const Eigen::Vector3d& p_W : nodes_W) {
    const double sun = lighting.sun ? sun_light(*lighting.sun, p_W, face.normal_W) : 0.0;
    map.steady.push_back(static_cast<float>(lighting.ambient + sun));
  }
  for (const Lamp& lamp : lighting.lamps) {
    std::vector<float> light;
    for (const Eigen::Vector3d& p_W : nodes_W)
      light.push_back(static_cast<float>(lamp_light(lamp, p_W, face.normal_W)));
    if (*std::max_element(light.begin(), light.end()) == 0.0F) light.clear();
    map.lamps.push_back(std::move(light));
  }
  return map;
}

std::vector<float> LightField::levels_at(double t_s) const {
  std::vector<float> levels;
  for (const Lamp& lamp : lamps_) levels.push_back(static_cast<float>(lamp_level(lamp, t_s)));
  return levels;
}

void LightField::update(double t_s) {
  std::vector<float> levels = levels_at(t_s);
  if (levels == levels_) return;
  levels_ = std::move(levels);
  for (Map& map : maps_) add_up(map);
}

PixelValues LightField::at(std::size_t face, const PixelValues& u, const PixelValues& v) const {
  if (maps_.empty()) return PixelValues::Ones(u.size());
  const Map& map = maps_[face];
  if (map.columns == 0) return PixelValues::Constant(u.size(), map.constant);
  const PixelValues x = (u * map.per_m_u + map.middle_u).max(0.0F).min(map.last_u);
  const PixelValues y = (v * map.per_m_v + map.middle_v).max(0.0F).min(map.last_v);
  PixelValues light(u.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const int ix = static_cast<int>(x[i]), iy = static_cast<int>(y[i]);
    const float fx = x[i] - static_cast<float>(ix), fy = y[i] - static_cast<float>(iy);
    const float* node = map.sum.data() + iy * map.columns + ix;
    const float top = node[0] + fx * (node[1] - node[0]);
    const float bottom = node[map.columns] + fx * (node[map.columns + 1] - node[map.columns]);
    light[i] = top + fy * (bottom - top);
  }
  return light;
}

void LightField::add_up(Map& map) const {
  if (map.columns == 0) {
    map.constant = map.lamp < 0 ? 1.0F : levels_[static_cast<std::size_t>(map.lamp)];
    return;
  }
  map.sum = map.steady;
  for (std::size_t i = 0; i < map.lamps.size(); ++i)
    for (std::size_t k = 0; k < map.lamps[i].size(); ++k) map.sum[k] += levels_[i] * map.lamps[i][k];
}

}  // namespace edged
