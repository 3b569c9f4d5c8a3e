// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pictures of a run: thumbnails with tracks.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "edged/track.hpp"

namespace edged {

/// A JPEG, at most widest_px wide, with each track and its previous position. `image` is not modified.
std::vector<unsigned char> track_picture(const cv::Mat& image, const std::vector<Track>& tracks, int widest_px);

}  // namespace edged
