// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The scene: textured rectangles that form a room with boxes or a single wall.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "edged/se3.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/light.hpp"
#include "edged/sim/simulator_config.hpp"
#include "edged/sim/texture.hpp"

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
  /// Before and after its time it approaches and leaves.
  double from_s = 0.0, to_s = 1e9;
  Eigen::Vector3d away_W = Eigen::Vector3d::Zero();  ///< [m/s]

  /// From where its faces have their centres.
  Eigen::Vector3d displacement(double t_s) const;
  Eigen::Vector3d velocity(double t_s) const;
};

/// A rectangle seen from the side its normal points to.
struct Face {
  Eigen::Vector3d centre_W, u_W, v_W, normal_W;  ///< the last three orthonormal, u x v = -normal
  double half_u = 0.0, half_v = 0.0;             ///< [m]
  int dynamic_object = -1;                       ///< of the scene, with which it moves; -1: it stays
  std::size_t texture = 0;                       ///< index into the scene
  float texels_per_m = 256.0F;
  float offset_u = 0.0F, offset_v = 0.0F;  ///< texel at the centre
  float brightness = 1.0F;                 ///< radiance of a white spot in light 1
  bool glows = false;                      ///< by itself, whatever light falls on it
  int lamp = -1;                           ///< a face that glows does so with this lamp of the scene; -1: always
};

struct Scene {
  std::vector<Texture> textures;
  std::vector<Face> faces;
  std::vector<DynamicObject> dynamic_objects;
  std::optional<Lighting> lighting;    ///< none: light 1 everywhere
  std::optional<Spotlight> spotlight;  ///< on top of it
};

/// The scene around a camera path: a closed room that holds all of it with objects that keep clear of it, a wall in
/// front of all of it, square to the mean optical axis, or a hall that does not depend on the path but for where its
/// furniture stands.
/// What the disturbance (filled in) wants is made, too: a blank wall (of a room only; the half of it at -x); a person,
/// who passes before the camera at T_W_C_meeting; walkers, to and fro before the camera's mean place; a lamp whose spot
/// wanders.
Scene make_scene(const SceneConfig& config, std::span<const SE3> path_W_C, std::uint64_t seed,
                 const Disturbance& disturbance = {}, const SE3& T_W_C_meeting = {});

}  // namespace edged
