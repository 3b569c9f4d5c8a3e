// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Light sources: lamps that are switched, the sun through a window, and ambient light.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "edged/sim/random.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// A small panel that shines into the half space in front of it, less to the sides.
struct Lamp {
  Eigen::Vector3d centre_W, axis_W;  ///< axis: unit, direction of the light
  double power = 1.0;                ///< radiance of a white surface 1 m in front of it
  std::vector<double> switch_s;      ///< instants at which it is switched, increasing; it is on at first [s]
};

/// Parallel rays through a rectangular hole in a wall.
struct SunWindow {
  Eigen::Vector3d centre_W, u_W, v_W;  ///< u and v orthonormal, in the wall
  double half_u = 0.0, half_v = 0.0;   ///< [m]
  Eigen::Vector3d direction_W;         ///< unit, direction of the light
  double power = 1.0;                  ///< radiance of a white surface perpendicular to the rays
};

/// A lamp with a narrow, moving beam at a fixed place.
struct Spotlight {
  Eigen::Vector3d centre_W, axis_W;  ///< axis: unit, mean direction of the beam
  double power = 1.0;                ///< radiance of a white surface perpendicular to the middle of the beam at 2 m
  double phase_yaw = 0.0, phase_pitch = 0.0;
  double begin_s = 0.0, end_s = 1e9;  ///< it is dark before and after
  std::vector<double> switch_s;       ///< instants in between at which it is switched, increasing
};

/// The beam at one instant.
struct Beam {
  Eigen::Vector3d centre, axis;  ///< unit axis
  double power = 0.0;            ///< at this instant
  double rate = 0.0;             ///< upper bound of the angular rate of the axis [rad/s]; 0 in the dark
};
Beam beam_at(const Spotlight& spot, double t_s);

/// Radiance of a white matt surface at p with unit normal n in the beam, all in one frame. It decreases gradually at
/// the edge of the cone.
float beam_light(const Beam& beam, const Eigen::Vector3f& p, const Eigen::Vector3f& n);

/// Only the wall around the window casts a shadow.
struct Lighting {
  double ambient = 1.0;  ///< radiance of a white surface by the reflections of all others
  double gloss = 0.0;    ///< share of a lamp's light that surfaces reflect like varnish
  std::vector<Lamp> lamps;
  std::optional<SunWindow> sun;
};

/// The lighting of a room of this size [m], with the origin at the centre of its floor. brightness: factor on all
/// lights. Lamps: two panels at the ceiling. Switched: weak panels and a lamp on each wall that goes on and off at
/// random times during duration_s. Sun: weak panels and a window in the wall at +y. Even has no lighting.
std::optional<Lighting> make_lighting(LightingKind kind, const Eigen::Vector3d& size, double brightness,
                                      double duration_s, Random& random);

constexpr double kSwitching_s = 0.02;

/// Share of its power at which the lamp shines. Switching takes kSwitching_s. t_s: since the start.
double lamp_level(const Lamp& lamp, double t_s);

/// Radiance of a white matt surface at p_W with unit normal n_W in the light of the lamp at full power: the cosines to
/// its axis and to the normal over the squared distance, bounded near the lamp by the size of the panel.
double lamp_light(const Lamp& lamp, const Eigen::Vector3d& p_W, const Eigen::Vector3d& n_W);

/// Radiance of a perfectly reflecting varnish at p with unit normal n in the light of the lamp at full power, seen from
/// the origin, all in one frame: a lobe of some 9 deg about the mirrored ray (Lafortune, Willems, "Using the modified
/// Phong reflectance model for physically based rendering", 1994).
double lamp_highlight(const Lamp& lamp, const Eigen::Vector3d& p, const Eigen::Vector3d& n);

/// Radiance of a white matt surface in the light of the sun, whose disc blurs the edges of the lit area.
double sun_light(const SunWindow& sun, const Eigen::Vector3d& p_W, const Eigen::Vector3d& n_W);

}  // namespace edged
