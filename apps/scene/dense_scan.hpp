// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the mapper of dense points gets of a step, and its points in the map frame.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "edged/dense/dense_mapper.hpp"
#include "edged/step.hpp"

namespace edged {

/// The dense points of one image, placed by the final trajectory.
struct DenseScan {
  struct Point {
    Eigen::Vector3d p_W;  ///< [m]
    double sigma_m;       ///< along the ray
    std::uint8_t grey;
  };
  Modality modality = Modality::Frames;
  Eigen::Vector3d from_W;  ///< position of the camera
  std::vector<Point> points;
};

using DenseScans = std::vector<DenseScan>;

/// The cameras of a rig as their images in steps are: event frames are undistorted.
std::vector<RigCamera> image_cameras(const Rig& given);

/// What is measured of a step with a pose. images: by image_cameras of the rig that the run began with; found: as
/// calibrated at the step.
DenseInstant dense_instant(const Step& step, const std::vector<RigCamera>& images, const Rig& found);

/// The points of the maps. Those of images without a final pose are left out.
DenseScans place(const std::vector<DepthMap>& maps, const Trajectory& poses, const Rig& rig);

/// A binary PLY, with grey as colour, and sigma along the ray [m].
std::string dense_ply(const DenseScans& scans);

}  // namespace edged
