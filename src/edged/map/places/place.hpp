// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Place recognition without a pose prior: descriptors oriented by gravity, and a pose from two points, as gravity gives
// the tilt.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "edged/frontend/descriptor.hpp"
#include "edged/se3.hpp"

namespace edged {

/// One for each feature; nothing near the image border, and where the ray is vertical, as gravity has no direction in
/// the image there. points: the same on the unit plane; up_C: the upward direction, in the camera.
std::vector<std::optional<Descriptor>> describe(const cv::Mat& image, std::span<const Eigen::Vector2d> pixels,
                                                std::span<const Eigen::Vector2d> points, const Eigen::Vector3d& up_C);

/// A feature of the present image that matches a map point by its descriptor.
struct PlaceMatch {
  Eigen::Vector2d point;  ///< the feature's, on the unit plane
  Eigen::Vector3d p_M;
};

struct PlacePose {
  SE3 T_M_C;
  std::size_t agreeing;  ///< number of matches
};

/// Whether a camera there sees the point within max_error on the unit plane.
bool agrees(const PlaceMatch& match, const SE3& T_C_M, double max_error);

/// The pose with most inliers, within max_error on the unit plane, refined by these. R_O_C: of the camera in any frame
/// whose z points up; the pose has the same tilt. Deterministic. Nothing with fewer than two matches.
std::optional<PlacePose> pose_by_gravity(std::span<const PlaceMatch> matches, const Eigen::Quaterniond& R_O_C,
                                         double max_error);

}  // namespace edged
