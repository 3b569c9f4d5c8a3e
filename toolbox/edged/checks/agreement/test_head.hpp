// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: what a camera and a gyro measure that are turned by hand.
#pragma once

#include <functional>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "edged/checks/agreement/test_motion.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// Frames of squares far away at 25 Hz, a gyro at 200 Hz.
class TurningHead {
 public:
  inline static const RigCamera kCamera{
      "frames", Modality::Frames, {240, 180, 200, 200, 120, 90, DistortionModel::None, {}}, {}, Duration(0)};

  /// moves_s: until then it is at rest.
  explicit TurningHead(double moves_s = 0.0) : moves_s_(moves_s) {
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) {
      Eigen::Vector3d direction;
      for (double& x : direction)
        x = 2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0;
      squares_.emplace_back(direction.normalized(), static_cast<double>(random() % 256));
    }
  }

  /// ahead_s: of the gyro's clock.
  void move_until(double end_s, double ahead_s, const std::function<void(Measurement)>& measured) {
    for (; 0.005 * n_ < end_s; ++n_) {
      const double t = 0.005 * n_;
      const auto rate = [&](double at) { return at < moves_s_ ? Eigen::Vector3d::Zero().eval() : uneven(at); };
      if (n_ % 8 == 0) measured(Frame{timestamp_from_seconds(t), kCamera.name, image()});
      measured(ImuSample{timestamp_from_seconds(t + ahead_s), rate(t), {0, 0, 9.81}});
      for (int i = 0; i < 5; ++i) q_ = (q_ * so3::exp(rate(t + 1e-3 * (i + 0.5)) * 1e-3)).normalized();
    }
  }

 private:
  cv::Mat image() const {
    cv::Mat image(180, 240, CV_8UC1, cv::Scalar(90));
    for (const auto& [direction, grey] : squares_) {
      const Eigen::Vector3d p = q_.conjugate() * direction;
      if (p.z() < 0.3) continue;
      const cv::Point2d at(120 + 200 * p.x() / p.z(), 90 + 200 * p.y() / p.z());
      cv::rectangle(image, {cv::Point(at * 16.0) - cv::Point(80, 80), cv::Size(160, 160)}, cv::Scalar(grey), cv::FILLED,
                    cv::LINE_8, 4);
    }
    return image;
  }

  double moves_s_;
  int n_ = 0;
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  std::vector<std::pair<Eigen::Vector3d, double>> squares_;
};

}  // namespace edged
