// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/frame_camera.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"

namespace edged {

void FrameCameraConfig::visit(ConfigFields& fields) {
  fields.add("rate_hz", rate_hz, {"Hz", 0.1, 1000, "frames per second"});
  fields.add("exposure_ms", exposure_ms, {"ms", 0.01, 1000, "time of exposure; the stamp is its middle"});
  fields.add("auto_exposure", auto_exposure, {.effect = "exposure_ms is only that of the first frame"});
  fields.add("min_exposure_ms", min_exposure_ms, {"ms", 0.01, 1000, "auto exposure: shortest"});
  fields.add("max_exposure_ms", max_exposure_ms, {"ms", 0.01, 1000, "auto exposure: longest"});
  fields.add("target_level", target_level, {"", 1, 254, "auto exposure: wanted mean grey level"});
  fields.add("electrons_per_ms", electrons_per_ms, {"1/ms", 1, 1e9, "signal of a white spot in good light"});
  fields.add("electrons_per_level", electrons_per_level, {"", 0.01, 1e6, "inverse gain: electrons for one grey level"});
  fields.add("read_noise_electrons", read_noise_electrons, {"", 0, 1e5, "noise that does not depend on light"});
  fields.add("pixel_gain_sigma", pixel_gain_sigma, {"", 0, 0.5, "spread of the gains of the pixels about 1"});
  fields.add("vignetting", vignetting, {"", 0, 1, "share of the light that is missing in the corners"});
}

std::uint8_t grey_level(double electrons, double read_noise, double electrons_per_level, Random& random) {
  const double noise = std::sqrt(electrons + read_noise * read_noise);
  const double level = (electrons + noise * random.normal()) / electrons_per_level;
  return static_cast<std::uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
}

namespace {

/// Gains of the pixels, row by row.
std::vector<double> gains(const FrameCameraConfig& config, int width, int height, std::uint64_t seed) {
  Random random(seed, 31);
  const Eigen::Vector2d middle(0.5 * (width - 1), 0.5 * (height - 1));
  std::vector<double> gains;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double corner = (Eigen::Vector2d(x, y) - middle).squaredNorm() / middle.squaredNorm();
      const double spread = config.pixel_gain_sigma > 0.0 ? config.pixel_gain_sigma * random.normal() : 0.0;
      gains.push_back(std::max(0.0, 1.0 + spread) * (1.0 - config.vignetting * corner));
    }
  }
  return gains;
}

}  // namespace

FrameCamera::FrameCamera(const FrameCameraConfig& config, int width, int height, std::uint64_t seed)
    : config_(config),
      width_(width),
      height_(height),
      random_(seed, 4),
      exposure_ms_(config.exposure_ms),
      light_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0F),
      gains_(gains(config, width, height, seed)) {}

void FrameCamera::expose(std::span<const float> begin, std::span<const float> end, double dt_s) {
  EDGED_CHECK(begin.size() == light_.size() && end.size() == light_.size(), "{} and {} pixels", begin.size(),
              end.size());
  const float half = static_cast<float>(0.5 * dt_s);
  for (std::size_t i = 0; i < light_.size(); ++i) light_[i] += half * (begin[i] + end[i]);
}

cv::Mat FrameCamera::read_out() {
  cv::Mat_<std::uint8_t> image(height_, width_);
  std::size_t i = 0;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x, ++i) {
      image(y, x) = grey_level(gains_[i] * (light_[i] * 1e3 * config_.electrons_per_ms), config_.read_noise_electrons,
                               config_.electrons_per_level, random_);
    }
  }
  std::fill(light_.begin(), light_.end(), 0.0F);
  if (config_.auto_exposure) adapt(image);
  return image;
}

void FrameCamera::adapt(const cv::Mat& image) {
  // A part of the correction in log exposure, at most a factor of two per frame, as in real cameras, to avoid
  // oscillation.
  const double factor = std::pow(config_.target_level / std::max(1.0, cv::mean(image)[0]), 0.6);
  exposure_ms_ = std::clamp(exposure_ms_ * std::clamp(factor, 0.5, 2.0), config_.min_exposure_ms,
                            std::max(config_.min_exposure_ms, config_.max_exposure_ms));
}

}  // namespace edged
