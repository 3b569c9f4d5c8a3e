// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Images of a textured, slanted plane, whose depth is known at every pixel.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <utility>
#include <vector>

#include "edged/dense/dense_mapper.hpp"

namespace edged {

/// z = 2 m + 0.2 x in O; grey values by place.
class TestPlane {
 public:
  using Texture = std::function<double(double x, double y)>;

  explicit TestPlane(Texture texture = blobs) : texture_(std::move(texture)) {}

  static double blobs(double x, double y) {
    return 128.0 + 40.0 * std::sin(9.0 * x + 5.0 * std::sin(4.3 * y)) * std::cos(11.0 * y + 3.0 * std::cos(5.9 * x)) +
           30.0 * std::sin(23.0 * x + 17.0 * y + 2.0 * std::sin(3.1 * x));
  }

  static const CameraModel& pinhole() {
    static const CameraModel model(160, 120, 140.0, 140.0, 79.5, 59.5);
    return model;
  }

  double depth(const SE3& T_O_C, const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d ray = T_O_C.rotation() * pinhole().pixel_to_point(pixel).homogeneous();
    const Eigen::Vector3d normal(-0.2, 0.0, 1.0);
    return (2.0 - normal.dot(T_O_C.translation())) / normal.dot(ray);
  }

  cv::Mat image(const SE3& T_O_C) const {
    cv::Mat image(pinhole().height(), pinhole().width(), CV_8UC1);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const Eigen::Vector3d p_O = T_O_C * (depth(T_O_C, {x, y}) * pinhole().pixel_to_point({x, y}).homogeneous());
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(texture_(p_O.x(), p_O.y()));
      }
    }
    return image;
  }

  DenseView view(const SE3& T_O_C) const {
    const cv::Mat grey = image(T_O_C);
    return {Timestamp{}, "frames", Modality::Frames, pinhole(), T_O_C, grey, smoothed(grey, EdgeConfig{})};
  }

  /// Number i of a flight along x, every third a keyframe; the camera is the body.
  DenseInstant instant(int i, const SE3& T_O_B) const {
    DenseInstant instant{.t = Timestamp(std::chrono::milliseconds(50 * i)), .keyframe = i % 3 == 0, .T_O_B = T_O_B};
    instant.scene_depth = 2.0;
    instant.images.push_back({"frames", Modality::Frames, pinhole(), {}, image(T_O_B)});
    return instant;
  }

  /// Median of the depth errors of all points, over the true depth.
  double median_error(const std::vector<DepthMap>& maps) const {
    std::vector<double> errors;
    for (const DepthMap& map : maps)
      for (const DensePoint& point : map.points)
        errors.push_back(std::abs(1.0 / (point.inverse_depth * depth(map.T_O_C, {point.x, point.y})) - 1.0));
    if (errors.empty()) return 1.0;
    std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
    return errors[errors.size() / 2];
  }

 private:
  Texture texture_;
};

inline SE3 shifted(double x_m) { return {Eigen::Quaterniond::Identity(), {x_m, 0.1 * x_m, 0.0}}; }

}  // namespace edged
