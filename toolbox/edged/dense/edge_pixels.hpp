// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The pixels of an image whose depth is worth a search: thin edges of frames, ridges of event frames.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

struct EdgeConfig {
  double sigma_px = 0.7;        ///< width of the Gaussian that smooths the image
  float least_strength = 4.0F;  ///< for a frame its slope [grey levels per px]; for an event frame the height of the
                                ///< ridge over what is 2 px beside it [grey levels]
  double most_share = 0.1;      ///< share of all pixels; of more edges the strongest of each cell of the image
  int border_px = 8;
};

/// As edges and matching need it: CV_32FC1.
cv::Mat smoothed(const cv::Mat& image, const EdgeConfig& config);

/// In rows from the top, in a row from the left. smooth: by smoothed().
std::vector<cv::Point> edge_pixels(const cv::Mat& smooth, Modality modality, const EdgeConfig& config);

}  // namespace edged
