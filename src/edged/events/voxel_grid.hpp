// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The input of a depth network: events of one window spread over time bins, cropped, normalised and padded
// (Hidalgo-Carrio, Gehrig, Scaramuzza, "Learning Monocular Dense Depth from Events", 3DV 2020).
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "edged/measurement.hpp"

namespace edged {

/// A grid is a CV_32FC1 cv::Mat of dimensions 1 x bins x height x width, continuous: what cv::dnn calls a blob.
/// Each event adds its polarity (+1, -1) to the two bins around its time t* = (bins - 1) (t - t_first) / (t_last -
/// t_first), linearly. t_first and t_last are of all the events given, the ones outside the region too. Raw pixels, no
/// interpolation in space. Events must be in time order; none give an empty grid (all zero).
cv::Mat voxel_grid(std::span<const Event> events, const cv::Rect& region, int bins = 5);

/// Non-zero voxels become (v - m) / s with their own mean m and population standard deviation s, over all bins; zeros
/// stay. Where all non-zero voxels are equal (s = 0) the grid stays as it is.
void normalise_voxels(cv::Mat& grid);

/// How one side of n pixels is filled up to a multiple.
struct Padding {
  int before = 0;  ///< left or top
  int after = 0;   ///< right or bottom
};

/// The half that is larger by one comes first. Network outputs are cut back to [before, before + n).
Padding padding_to_multiple(int n, int multiple);

/// Pads height and width to multiples by reflection at the border pixels (which are not repeated). Both sides of the
/// grid must be at least `multiple` long.
cv::Mat pad_voxels(const cv::Mat& grid, int multiple);

/// The mean of every block of factor x factor pixels; height and width must be multiples of factor.
cv::Mat shrink_voxels(const cv::Mat& grid, int factor);

/// The part in the middle with this share (0..1] of each side, at least one pixel.
cv::Rect central_region(const cv::Size& image, double share);

/// The region grown by margin_px on each side where the image has room.
cv::Rect grown_region(const cv::Rect& region, int margin_px, const cv::Size& image);

}  // namespace edged
