// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The marker families of the targets.
#pragma once

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>

namespace edged {

/// The family of an AprilGrid, else that of a charuco.
inline cv::Ptr<cv::aruco::Dictionary> tag_family(bool april) {
  return cv::aruco::getPredefinedDictionary(april ? cv::aruco::DICT_APRILTAG_36h11 : cv::aruco::DICT_6X6_250);
}

/// Width of the dark border, in bits: Kalibr prints two.
inline int border_bits(bool april) { return april ? 2 : 1; }

/// Sizes in units of a square.
inline cv::Ptr<cv::aruco::CharucoBoard> charuco_board(int columns, int rows, double ratio) {
  return cv::aruco::CharucoBoard::create(columns, rows, 1.0F, static_cast<float>(ratio), tag_family(false));
}

}  // namespace edged
