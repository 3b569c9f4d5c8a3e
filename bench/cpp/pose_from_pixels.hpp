// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The pose of a camera from shifts of pixels whose points are known, and the pictures that these are measured on.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// What is measured: g dx = r for the shift dx of the pixel of p.
struct Row {
  double r, weight;
  Eigen::Vector2d g;
  Eigen::Vector3d p;  ///< in the camera now
};
using Rows = std::function<std::vector<Row>(const SE3& T_now_keyframe)>;

/// Gauss-Newton with Cauchy's weights and a weak prior at the start. held: the rotation is that of the start.
SE3 align(const CameraModel& camera, const SE3& start, bool held, const Rows& rows_at);

/// Bilinear, of CV_32FC1; 0 outside.
float at(const cv::Mat& image, const Eigen::Vector2d& pixel);
cv::Mat blurred(const cv::Mat& image, double sigma_px);
/// Derivatives by x and y.
std::array<cv::Mat, 2> gradient(const cv::Mat& image);

struct Ridge {
  Eigen::Vector2d pixel, normal;
  double height;
};
/// Lines of a picture of CV_32FC1 that are as high, with subpixel accuracy; normals to either side.
std::vector<Ridge> ridges(const cv::Mat& picture, double least, int border_px);

struct Peak {
  double place, height;  ///< [px] from where the search began
};
/// The highest one of sign times the picture, on a line to both sides of a pixel.
std::optional<Peak> find_peak(const cv::Mat& picture, const Eigen::Vector2d& pixel, const Eigen::Vector2d& direction,
                              double reach_px, double sign, double least);

}  // namespace edged
