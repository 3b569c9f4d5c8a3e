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

#include "edged/options/frontend.hpp"

namespace edged {

struct Corner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double response = 0.0;  ///< comparable within one call only
};

/// At most `limit` new corners of a CV_8UC1 image, strongest first, one per free cell. Cells that hold a pixel of
/// `occupied`, and the neighbourhood of those pixels, stay free of corners. Lengths of the config that say "at 240 px"
/// grow with the width of the image. An image too small for the border gives none. Paper Eq. 3, with K_ij instead of K
/// and cells without a candidate skipped. unused: CV_8UC1, not zero where no corner may be; empty: nowhere.
std::vector<Corner> detect_corners(const cv::Mat& image, std::span<const Eigen::Vector2d> occupied, int limit,
                                   const DetectorConfig& config, const cv::Mat& unused = {});

}  // namespace edged
