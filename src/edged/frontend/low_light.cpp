// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/low_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

struct Range {
  double dark = 0.0, bright = 0.0;
};

Range grey_range(const cv::Mat& image) {
  std::array<std::size_t, 256> histogram{};
  for (int row = 0; row < image.rows; ++row) {
    const std::uint8_t* pixel = image.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.cols; ++column) ++histogram[pixel[column]];
  }
  const auto quantile = [&](double share) {
    double left = share * static_cast<double>(image.total());
    std::size_t level = 0;
    while (level < 255 && left > static_cast<double>(histogram[level])) left -= static_cast<double>(histogram[level++]);
    return static_cast<double>(level);
  };
  return {quantile(kFrontendTuning.dark_share), quantile(1.0 - kFrontendTuning.dark_share)};
}

}  // namespace

void LowLightConfig::visit(ConfigFields& fields) {
  fields.add("below_range", below_range,
             {"grey", 0, 255, "Frames whose grey levels span less are smoothed and stretched. 0: none."});
}

cv::Mat LowLightNormalizer::operator()(const cv::Mat& image) {
  if (image.empty() || image.type() != CV_8UC1) return image;  // the tracker reports the error
  const Range range = grey_range(image);
  const double width = std::max(range.bright - range.dark, 1.0);
  if (width >= config_.below_range) {
    gain_ = 1.0;
    return image;
  }
  const double wanted = std::clamp(kFrontendTuning.target_range / width, 1.0, kFrontendTuning.max_gain);
  const bool other_light = std::max(wanted / gain_, gain_ / wanted) > kFrontendTuning.hold_gain;
  if (other_light ||
      gain_ * std::abs(range.dark - black_) > kFrontendTuning.hold_black_share * kFrontendTuning.target_range) {
    gain_ = wanted;
    black_ = range.dark;
  }
  cv::Mat smooth, stretched;
  image.convertTo(smooth, CV_32F, gain_, kFrontendTuning.floor - gain_ * black_);
  cv::GaussianBlur(smooth, smooth, cv::Size(), kFrontendTuning.smoothing_px);
  smooth.convertTo(stretched, CV_8U);
  return stretched;
}

}  // namespace edged
