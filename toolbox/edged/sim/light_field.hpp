// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The light on each face of a scene, in maps that are recomputed when a lamp changes.
#pragma once

#include <cstdint>
#include <vector>

#include "edged/sim/scene.hpp"

namespace edged {

class LightField {
 public:
  /// Without lighting, each face has light 1.
  explicit LightField(const Scene& scene);

  /// Sets the lamps to their state at t_s seconds.
  void update(double t_s);

  /// Radiance of a white spot of brightness 1 at (u, v) [m] from the centre of the face, bilinear between nodes 2.5 cm
  /// apart.
  float at(std::size_t face, float u, float v) const {
    if (maps_.empty()) return 1.0F;
    const Map& map = maps_[face];
    if (map.columns == 0) return map.constant;
    const float x = std::min(std::max(0.0F, u * map.per_m_u + map.middle_u), map.last_u);
    const float y = std::min(std::max(0.0F, v * map.per_m_v + map.middle_v), map.last_v);
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const float* node = map.sum.data() + iy * map.columns + ix;
    const float top = node[0] + fx * (node[1] - node[0]);
    const float bottom = node[map.columns] + fx * (node[map.columns + 1] - node[map.columns]);
    return top + fy * (bottom - top);
  }

 private:
  struct Map {
    int columns = 0, rows = 0;  // 0 for a face that glows
    int lamp = -1;              // the lamp with which the face glows
    float constant = 1.0F;
    float per_m_u = 0.0F, per_m_v = 0.0F, middle_u = 0.0F, middle_v = 0.0F, last_u = 0.0F, last_v = 0.0F;
    std::vector<float> steady, sum;         // steady: ambient light and sun; sum: all light
    std::vector<std::vector<float>> lamps;  // each lamp at full power; empty if its light does not reach the face
  };

  static Map make_map(const Face& face, const Lighting& lighting);
  std::vector<float> levels_at(double t_s) const;
  void add_up(Map& map) const;

  std::vector<Lamp> lamps_;
  std::vector<float> levels_;  // of the lamps, in the sums
  std::vector<Map> maps_;
};

}  // namespace edged
