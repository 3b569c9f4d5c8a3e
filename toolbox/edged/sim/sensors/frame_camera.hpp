// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A standard camera: light integrated over an exposure, with noise, in eight bits.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "edged/sim/random.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// The 8-bit value of a pixel from its electrons, with photon noise and read noise [electrons].
std::uint8_t grey_level(double electrons, double read_noise, double electrons_per_level, Random& random);

class FrameCamera {
 public:
  FrameCamera(const FrameCameraConfig& config, int width, int height, std::uint64_t seed);

  /// Adds the light of dt_s seconds between two pictures (linear, width x height). The brightness is linear in time in
  /// between.
  void expose(std::span<const float> begin, std::span<const float> end, double dt_s);

  /// The image (CV_8UC1) of the light since the previous one.
  cv::Mat read_out();

  /// Exposure of the next frame [ms]. With auto_exposure, it is a part of the correction by the mean grey level of the
  /// last frame, within its bounds.
  double exposure_ms() const { return exposure_ms_; }

 private:
  FrameCameraConfig config_;
  void adapt(const cv::Mat& image);

  int width_, height_;
  Random random_;
  double exposure_ms_;
  std::vector<float> light_;   // radiance times seconds
  std::vector<double> gains_;  // of the pixels, 1 on average in the middle
};

}  // namespace edged
