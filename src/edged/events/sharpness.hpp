// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Sharpness of an event frame: well compensated events accumulate on edges and raise the contrast
// (Gallego, Rebecq, Scaramuzza, "A Unifying Contrast Maximization Framework for Event Cameras", CVPR 2018).
#pragma once

#include <opencv2/core/mat.hpp>

namespace edged {

/// Variance of the values of a one-channel image; 0 for an empty one.
double image_variance(const cv::Mat& image);

}  // namespace edged
