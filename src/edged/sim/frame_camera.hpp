// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A standard camera: light collected over an exposure, noise, eight bits.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "edged/core/config.hpp"
#include "edged/sim/random.hpp"

namespace edged {

struct FrameCameraConfig {
  double rate_hz = 24.0;
  double exposure_ms = 8.0;
  double electrons_per_ms = 2500.0;
  double electrons_per_level = 80.0;
  double read_noise_electrons = 45.0;

  void visit(ConfigFields& fields);
};

class FrameCamera {
 public:
  FrameCamera(const FrameCameraConfig& config, int width, int height, std::uint64_t seed);

  /// Adds the light of dt_s seconds between two pictures (linear, width x height), brightness linear in time in
  /// between.
  void expose(std::span<const float> begin, std::span<const float> end, double dt_s);

  /// CV_8UC1 of the light collected since the last one.
  cv::Mat read_out();

 private:
  FrameCameraConfig config_;
  int width_, height_;
  Random random_;
  std::vector<float> light_;  // radiance times seconds
};

}  // namespace edged
