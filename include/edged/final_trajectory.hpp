// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The final trajectory and the map: poses and map points estimated from all measurements, and single map matches.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"

namespace edged {

/// An observation of a map point in an image.
struct MapMatch {
  Timestamp keyframe;       ///< creation time of its keyframe, IMU clock
  Eigen::Vector2d pixel;    ///< undistorted in an event frame, as recorded in a standard frame
  Eigen::Vector3d p_W;      ///< position in the map [m]
  std::string camera = {};  ///< camera of the image
};

/// A keyframe of the map, and its map points.
struct MappedKeyframe {
  struct Point {
    Eigen::Vector3d p_W;       ///< [m]
    std::uint8_t grey;         ///< intensity of its pixel in the keyframe
    int tried = 0, found = 0;  ///< number of images in which it was searched for, and matched
  };
  Timestamp t;  ///< IMU clock
  SE3 T_W_B;
  std::string camera;   ///< camera of its image; of several, separated by blanks
  int times_found = 0;  ///< number of later images with matches of its points
  Timestamp found_at;   ///< time of the last match; t without any
  std::vector<Point> points;
};

/// Called after each step of the joint optimization with the share of its steps that are done: at most 1, and less
/// where it converges early.
using OptimizationProgress = std::function<void(double share)>;

/// The joint solution of all keyframes by all measurements. It is not causal; the causal trajectory is in the steps.
struct FinalTrajectory {
  Trajectory poses;                       ///< T_W_B at the time of each Good or Degraded step, IMU clock
  std::vector<MappedKeyframe> keyframes;  ///< keyframes that the map still holds
  /// Half the sum of the squared residuals of all measurements, with their robust losses, before and after.
  double initial_cost = 0.0, final_cost = 0.0;
};

}  // namespace edged
