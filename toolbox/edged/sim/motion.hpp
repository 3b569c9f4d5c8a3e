// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The motion of the simulated body: smooth random motion, a recorded one, or the flight of a quadrotor.
#pragma once

#include <cstdint>
#include <string>

#include "edged/config.hpp"
#include "edged/sim/flight.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

enum class PoseOf { Camera, Body };

struct MotionConfig {
  std::string file;  ///< TUM trajectory to follow; empty: random motion
  Manoeuvre flight = Manoeuvre::None;
  double start_s = 0.0;
  PoseOf pose_of = PoseOf::Camera;
  double rest_s = 1.0;
  double blend_s = 1.0;
  double knot_s = 0.05;
  double extent_m = 0.6;
  double max_angle_deg = 35.0;
  double max_speed = 0.8;
  double max_rate_deg_s = 45.0;

  void visit(ConfigFields& fields);
};

/// The motion of the body for duration_s seconds. Random motion sways the camera around a point 1.3 m above the ground,
/// its axis level and along +x on average. A flight has its own length, whatever duration_s is. Throws
/// InputError when the file is shorter than asked for.
ContinuousTrajectory make_motion(const MotionConfig& config, double duration_s, const SE3& T_B_C, std::uint64_t seed);

}  // namespace edged
