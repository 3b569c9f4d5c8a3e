// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is known of path and map: of a point the moment it is found again, of all of them in the end.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"

namespace edged {

/// A point of the map that was found again in an image.
struct MapMatch {
  Timestamp
      keyframe;  ///< when the keyframe was made that it belongs to, IMU clock: how far this observation reaches back
  Eigen::Vector2d pixel;  ///< where it was found: undistorted on the event frame, as given on the standard frame
  Eigen::Vector3d p_W;    ///< where the map has it [m]
};

/// A keyframe that the map has kept, and its points.
struct MappedKeyframe {
  struct Point {
    Eigen::Vector3d p_W;       ///< [m]
    std::uint8_t grey;         ///< of its image there
    int tried = 0, found = 0;  ///< in how many images it was looked for, and found
  };
  Timestamp t;  ///< IMU clock
  SE3 T_W_B;
  std::string camera;   ///< whose image it was
  int times_found = 0;  ///< in how many images points of it were found again
  Timestamp found_at;   ///< the last time; t where they never were
  std::vector<Point> points;
};

/// Not causal: what came later has its part in it. What was known at its time is in the steps.
struct FinalTrajectory {
  Trajectory poses;                       ///< T_W_B at the time of each Good or Degraded step, IMU clock
  std::vector<MappedKeyframe> keyframes;  ///< those that the map still has
};

}  // namespace edged
