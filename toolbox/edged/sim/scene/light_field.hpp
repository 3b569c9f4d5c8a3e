// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The light on each face of a scene, in maps that are recomputed when a lamp changes.
#pragma once

#include <cstddef>
#include <vector>

#include "edged/sim/scene/scene.hpp"
#include "edged/sim/sensors/pixel_values.hpp"

namespace edged {

class LightField {
 public:
  /// Without lighting, each face has light 1.
  explicit LightField(const Scene& scene);

  /// Sets the lamps to their state at t_s seconds.
  void update(double t_s);

  /// Radiance of a white spot of brightness 1 at each (u, v) [m] from the centre of the face, bilinear between nodes
  /// 2.5 cm apart.
  PixelValues at(std::size_t face, const PixelValues& u, const PixelValues& v) const;

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
