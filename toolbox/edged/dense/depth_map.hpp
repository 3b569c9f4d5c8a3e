// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The inverse depths of the edge pixels of one reference image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "edged/dense/depth_search.hpp"
#include "edged/dense/edge_pixels.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// One image of a pinhole with its pose.
struct DenseView {
  Timestamp t;
  std::string camera;
  Modality modality = Modality::Frames;
  CameraModel pinhole;
  SE3 T_O_C;
  cv::Mat image;                                   ///< CV_8UC1
  cv::Mat smooth;                                  ///< smoothed(image)
  Eigen::Vector2d flow = Eigen::Vector2d::Zero();  ///< motion of its middle since the view before [px]
};

struct DensePoint {
  std::uint16_t x = 0, y = 0;  ///< [px]
  float inverse_depth = 0.0F;  ///< 1 / z [1/m]
  float sigma = 0.0F;          ///< sigma of inverse_depth
  std::uint8_t grey = 0;
  std::uint8_t views = 0;  ///< that agree, of all keyframes from which it was fused; 255: and more

  Eigen::Vector3d in_camera(const CameraModel& pinhole) const {
    return pinhole.pixel_to_point({x, y}).homogeneous() / inverse_depth;
  }
};

struct DepthMap {
  Timestamp t;  ///< IMU clock
  std::string camera;
  CameraModel pinhole;
  SE3 T_O_C;
  std::size_t edges = 0;           ///< number of edge pixels of the image
  std::vector<DensePoint> points;  ///< pixels with depth, in rows from the top
};

struct CullConfig {
  int reach_px = 3;          ///< neighbours are so near
  int least_neighbours = 2;  ///< with the same depth
  double same_share = 0.05;  ///< inverse depths are the same within this share, and the gate
  double gate_sigmas = 3.0;
};

/// views: other images, by baseline, the shortest first.
DepthMap estimate_depth(const DenseView& reference, std::span<const DenseView* const> views,
                        const InverseDepthRange& range, const SearchConfig& search, const EdgeConfig& edges);

/// Removes points that too few neighbours support, or more contradict.
void cull(DepthMap& map, const CullConfig& config);

/// Moves the points of `older` that `newer` shows with the same depth, to a pixel, into it: both together are one
/// estimate.
void fuse(DepthMap& older, DepthMap& newer, const CullConfig& config);

}  // namespace edged
