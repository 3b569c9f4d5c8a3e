// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corner detection on a grid: the strongest corner of every cell that holds no live track (paper Eq. 3, "grid ORB").
// The grid has C = round(width / cell) columns and R = round(height / cell) rows, with cell = cell_px * width / 240;
// cells differ by at most a pixel, and none of the image is left over.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "edged/core/config.hpp"

namespace edged {

enum class CornerKind {
  /// FAST-9 candidates ranked by the Harris score: the detector of ORB (Rublee et al., 2011), so there is no kind Orb
  /// beside it. What ORB adds are scales (DetectorConfig::levels), a cut to the strongest of the whole image, which
  /// would come before the grid and defeat it, and descriptors, which tracking by optical flow does not use.
  FastHarris,
  Fast,       ///< FAST-9 ranked by its own score: the detector of USLAM
  ShiTomasi,  ///< local maxima of the smaller eigenvalue of the structure tensor (Shi and Tomasi, 1994)
};

struct DetectorConfig {
  CornerKind corners = CornerKind::FastHarris;
  int max_features = 120;
  double cell_px = 20.0;
  int levels = 1;  ///< scales the corners are found at, each kLevelFactor coarser than the one before
  double separation_px = 8.0;
  int border_px = 8;
  int fast_threshold = 20;
  int fast_threshold_low = 8;
  double min_gradient = 2.0;
  bool subpixel = false;

  static constexpr double kLevelFactor = 1.2;  ///< as ORB

  void visit(ConfigFields& fields);
};

struct Corner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double response = 0.0;  ///< comparable within one call only
};

/// At most `limit` new corners of a CV_8UC1 image, strongest first, one per free cell. Cells that hold a pixel of
/// `occupied`, and the neighbourhood of those pixels, stay free of corners. Lengths of the config that say "at 240 px"
/// grow with the width of the image. An image too small for the border gives none. Paper Eq. 3, with K_ij instead of K
/// and cells without a candidate skipped.
std::vector<Corner> detect_corners(const cv::Mat& image, std::span<const Eigen::Vector2d> occupied, int limit,
                                   const DetectorConfig& config);

}  // namespace edged
