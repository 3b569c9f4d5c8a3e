// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The look of a corner, kept to find it again.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edged/options/frontend.hpp"

namespace edged {

/// Grey levels around a corner, row by row; the corner lies in the middle, between pixels.
struct Patch {
  static constexpr int kSize = 14;
  std::array<std::uint8_t, kSize * kSize> pixels{};

  /// One of the four around the corner.
  std::uint8_t middle() const { return pixels[(kSize / 2) * kSize + kSize / 2]; }
};

/// Nothing where it would reach beyond the image. image: CV_8UC1.
std::optional<Patch> cut_patch(const cv::Mat& image, const Eigen::Vector2d& corner);

struct PatchMatch {
  Eigen::Vector2d pixel;
  double similarity;  ///< normalised cross correlation
};

/// Looks for the patch around `expected`, up to radius_px from there: first pixel by pixel, then to a fraction of one
/// by inverse-compositional alignment, whatever the image's gain and offset. A: pixels of the image by pixels of the
/// patch (2x2). Nothing where it is not found, or the look leaves the image.
std::optional<PatchMatch> match_patch(const Patch& patch, const cv::Mat& image, const Eigen::Vector2d& expected,
                                      const Eigen::Matrix2d& A, double radius_px, const PatchConfig& config);

}  // namespace edged
