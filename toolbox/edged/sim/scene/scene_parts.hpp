// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a scene consists of.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "edged/sim/scene/flicker.hpp"
#include "edged/sim/scene/light.hpp"
#include "edged/sim/scene/texture.hpp"

namespace edged {

/// The motion of a dynamic object.
struct DynamicObject {
  /// Oscillation: reach_W * sin(omega * t + phase).
  struct Swing {
    Eigen::Vector3d reach_W;  ///< [m]
    double omega = 0.0, phase = 0.0;
  };

  Eigen::Vector3d velocity_W = Eigen::Vector3d::Zero();  ///< [m/s]
  std::vector<Swing> swings = {};
  /// It moves with away_W before from_s and after to_s: it approaches and leaves.
  double from_s = 0.0, to_s = 1e9;
  Eigen::Vector3d away_W = Eigen::Vector3d::Zero();  ///< [m/s]

  /// Displacement from the centres of its faces.
  Eigen::Vector3d displacement(double t_s) const;
  Eigen::Vector3d velocity(double t_s) const;
};

/// A rectangle that is visible from the side of its normal.
struct Face {
  Eigen::Vector3d centre_W, u_W, v_W, normal_W;  ///< the last three orthonormal, u x v = -normal
  double half_u = 0.0, half_v = 0.0;             ///< [m]
  int dynamic_object = -1;                       ///< index into the scene: the face moves with it; -1: static
  std::size_t texture = 0;                       ///< index into the scene
  float texels_per_m = 256.0F;
  float offset_u = 0.0F, offset_v = 0.0F;  ///< texel at the centre
  float brightness = 1.0F;                 ///< radiance of a white spot in light 1
  bool glows = false;                      ///< its radiance does not depend on the light
  int lamp = -1;                           ///< the face glows while this lamp of the scene is on; -1: always
};

struct Scene {
  std::vector<Texture> textures;
  std::vector<Face> faces;
  std::vector<DynamicObject> dynamic_objects;
  std::optional<Lighting> lighting;    ///< none: light 1 everywhere
  std::optional<Spotlight> spotlight;  ///< in addition
  std::optional<Flicker> flicker;      ///< flicker of all these lights
};

}  // namespace edged
