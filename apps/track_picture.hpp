// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An image of a camera made small, with the corners that were followed on it.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "edged/track.hpp"

namespace edged {

/// JPEG, not wider than widest_px. Each corner with where it was one image ago; the image is not written on.
std::vector<unsigned char> track_picture(const cv::Mat& image, const std::vector<Track>& tracks, int widest_px);

}  // namespace edged
