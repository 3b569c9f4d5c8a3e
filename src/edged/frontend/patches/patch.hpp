// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The reference patch of a feature, and its alignment to later images.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "edged/options/frontend.hpp"

namespace edged {

/// Grey levels around a feature, row by row; the feature lies in the middle, between pixels.
struct Patch {
  static constexpr int kSize = 14;
  std::array<std::uint8_t, kSize * kSize> pixels{};

  /// One of the four pixels around the feature.
  std::uint8_t middle() const { return pixels[(kSize / 2) * kSize + kSize / 2]; }
};

/// Where a patch lies in an image: its middle [px], and pixels of the image by pixels of the patch.
struct PatchPlace {
  Eigen::Vector2d pixel;
  Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
};

/// Nothing where it would reach beyond the image. image: CV_8UC1.
std::optional<Patch> cut_patch(const cv::Mat& image, const PatchPlace& place);

/// Normalised cross correlation of the patch at each place; -1 where it leaves the image or is uniform.
std::vector<double> correlations(const Patch& patch, const cv::Mat& image, std::span<const PatchPlace> places);

struct PatchMatch {
  Eigen::Vector2d pixel;
  double similarity;  ///< normalised cross correlation
};

/// Searches for the patch within radius_px of `expected`: first in whole pixels, then with subpixel accuracy by
/// inverse-compositional alignment, independent of gain and offset of the image. A: pixels of the image by pixels of
/// the patch (2x2). Nothing if there is no match, or the patch leaves the image.
std::optional<PatchMatch> match_patch(const Patch& patch, const cv::Mat& image, const Eigen::Vector2d& expected,
                                      const Eigen::Matrix2d& A, double radius_px, const PatchConfig& config);

}  // namespace edged
