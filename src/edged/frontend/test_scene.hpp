// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests and benchmarks: a textured plane seen by a pinhole camera, with the exact motion of every pixel.
#pragma once

#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

inline CameraModel davis_like_pinhole() { return {240, 180, 200.0, 200.0, 119.5, 89.5}; }

/// Smooth noise of several sizes, CV_8UC1; the same pixels every time.
inline cv::Mat random_texture(int width, int height, std::uint64_t seed = 1) {
  cv::RNG random(seed);
  cv::Mat sum = cv::Mat::zeros(height, width, CV_32F);
  for (const double sigma : {1.5, 3.0, 6.0}) {
    cv::Mat noise(height, width, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
    cv::GaussianBlur(noise, noise, cv::Size(), sigma);
    sum += noise * sigma;  // the same contrast at every size
  }
  cv::Mat texture;
  cv::normalize(sum, texture, 10, 245, cv::NORM_MINMAX, CV_8U);
  return texture;
}

/// The plane Z = depth of the world; the axis of the camera at identity is perpendicular to it.
class PlaneScene {
 public:
  PlaneScene(const CameraModel& camera, double depth)
      : camera_(camera), depth_(depth), texture_(random_texture(4 * camera.width(), 4 * camera.height())) {}

  const CameraModel& camera() const { return camera_; }
  double depth() const { return depth_; }

  /// The image of the camera; black outside the texture.
  cv::Mat image(const SE3& T_W_C) const {
    Eigen::Matrix3d plane_to_texture;  // one texture pixel per image pixel seen from identity, its centre on the axis
    plane_to_texture << camera_.fx() / depth_, 0, 2.0 * camera_.width(), 0, camera_.fy() / depth_,
        2.0 * camera_.height(), 0, 0, 1;
    const Eigen::Matrix3d H = plane_to_pixel(T_W_C) * plane_to_texture.inverse();
    cv::Mat_<double> matrix(3, 3);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) matrix(r, c) = H(r, c);
    }
    cv::Mat out;
    cv::warpPerspective(texture_, out, matrix, cv::Size(camera_.width(), camera_.height()), cv::INTER_CUBIC);
    return out;
  }

  /// Where a pixel of view 1 is in view 2; nothing when behind the camera.
  std::optional<Eigen::Vector2d> moved(const Eigen::Vector2d& pixel, const SE3& T_W_C1, const SE3& T_W_C2) const {
    const Eigen::Vector3d ray_W = T_W_C1.R() * camera_.pixel_to_point(pixel).homogeneous();
    const double range = (depth_ - T_W_C1.translation().z()) / ray_W.z();
    return camera_.project(T_W_C2.inverse() * Eigen::Vector3d(T_W_C1.translation() + range * ray_W));
  }

 private:
  Eigen::Matrix3d plane_to_pixel(const SE3& T_W_C) const {
    const SE3 T_C_W = T_W_C.inverse();
    Eigen::Matrix3d K;
    K << camera_.fx(), 0, camera_.cx(), 0, camera_.fy(), camera_.cy(), 0, 0, 1;
    Eigen::Matrix3d M;
    M << T_C_W.R().leftCols<2>(), T_C_W.R().col(2) * depth_ + T_C_W.translation();
    return K * M;
  }

  CameraModel camera_;
  double depth_;
  cv::Mat texture_;
};

}  // namespace edged
