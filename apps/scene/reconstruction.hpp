// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Undistorted images with poses, and the points that they observe, as COLMAP, nerfstudio and viewers of point clouds
// read them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/step.hpp"
#include "edged/time.hpp"
#include "edged/track.hpp"

namespace edged {

/// Observations are in pixels of the ideal pinhole of their camera, (0, 0) the centre of the first.
struct Reconstruction {
  struct Camera {
    std::string name;
    CameraModel pinhole;
    Modality modality = Modality::Frames;
  };
  struct Observation {
    FeatureId feature = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    std::uint8_t grey = 0;
    std::size_t point = kNone;  ///< index into points
  };
  struct Image {
    std::string file;  ///< below the folder of the images
    Timestamp t;       ///< IMU clock
    std::size_t camera = 0;
    SE3 T_W_C;
    std::vector<Observation> observations;
  };
  /// An observation by its indices.
  struct Seen {
    std::size_t image, observation;
  };
  struct Point {
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();              ///< [m]
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();       ///< [m^2], of its observations with sigma 1 px
    Eigen::Vector3d towards_cameras = Eigen::Vector3d::Zero();  ///< mean direction, a unit vector
    std::uint8_t grey = 0;
    double error_px = 0.0;  ///< mean reprojection error
    std::vector<Seen> seen;
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  std::vector<Camera> cameras;
  std::vector<Image> images;
  std::vector<Point> points;
};

/// The tracks that lie in the image of the pinhole.
std::vector<Reconstruction::Observation> observations_of(const std::vector<Track>& tracks, const CameraModel& pinhole);

/// Appends the images of a step, without files: what its cameras observe, if they are among those of the model.
void add_images(Reconstruction& model, const Step& step);

/// Sets T_W_C of the images by the final trajectory and calibration. Those without a final pose are left out.
void place(Reconstruction& model, const Trajectory& poses, const Rig& rig);

/// Fills `points` by triangulation of the features with the poses of the images: those of two observations and more
/// whose depth is known to a tenth. Observations off by more than 2 px are left out.
void triangulate(Reconstruction& model);

/// cameras, images and points3D of a model of COLMAP: binary in sparse/0, as text in sparse_text/0. Throws InputError
/// if they cannot be written.
void write_colmap(const std::filesystem::path& folder, const Reconstruction& model);
/// transforms.json of nerfstudio; images are in images/ beside it.
std::string transforms_json(const Reconstruction& model);
/// points.ply, with grey as colour, the direction to the cameras as normal, and the upper triangle of the covariance.
std::string points_ply(const Reconstruction& model);

}  // namespace edged
