// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The marker families of the targets, by OpenCV 4.5 to 4.6 and, with other names, from 4.7 on.
#pragma once

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <vector>

namespace edged {

/// A charuco.
struct BoardPoints {
  std::vector<int> ids;                           ///< of its markers
  std::vector<std::vector<cv::Point3f>> markers;  ///< their corners
  std::vector<cv::Point3f> corners;               ///< inner ones of the chessboard
};

#if CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR < 407
inline cv::Ptr<cv::aruco::Dictionary> predefined(cv::aruco::PREDEFINED_DICTIONARY_NAME name) {
  return cv::aruco::getPredefinedDictionary(name);
}
inline void draw_marker(const cv::aruco::Dictionary& family, int id, int side, cv::Mat& out, int border) {
  family.drawMarker(id, side, out, border);
}
inline cv::Ptr<cv::aruco::CharucoBoard> board_of(int columns, int rows, float ratio,
                                                 const cv::Ptr<cv::aruco::Dictionary>& family) {
  return cv::aruco::CharucoBoard::create(columns, rows, 1.0F, ratio, family);
}
inline BoardPoints points_of(const cv::aruco::CharucoBoard& board) {
  return {board.ids, board.objPoints, board.chessboardCorners};
}
#else
inline cv::Ptr<cv::aruco::Dictionary> predefined(cv::aruco::PredefinedDictionaryType name) {
  return cv::makePtr<cv::aruco::Dictionary>(cv::aruco::getPredefinedDictionary(name));
}
inline void draw_marker(const cv::aruco::Dictionary& family, int id, int side, cv::Mat& out, int border) {
  family.generateImageMarker(id, side, out, border);
}
inline cv::Ptr<cv::aruco::CharucoBoard> board_of(int columns, int rows, float ratio,
                                                 const cv::Ptr<cv::aruco::Dictionary>& family) {
  return cv::makePtr<cv::aruco::CharucoBoard>(cv::Size(columns, rows), 1.0F, ratio, *family);
}
inline BoardPoints points_of(const cv::aruco::CharucoBoard& board) {
  return {board.getIds(), board.getObjPoints(), board.getChessboardCorners()};
}
#endif

/// The family of an AprilGrid, else that of a charuco.
inline cv::Ptr<cv::aruco::Dictionary> tag_family(bool april) {
  return predefined(april ? cv::aruco::DICT_APRILTAG_36h11 : cv::aruco::DICT_6X6_250);
}

/// Width of the dark border, in bits: Kalibr prints two.
inline int border_bits(bool april) { return april ? 2 : 1; }

/// Sizes in units of a square.
inline cv::Ptr<cv::aruco::CharucoBoard> charuco_board(int columns, int rows, double ratio) {
  return board_of(columns, rows, static_cast<float>(ratio), tag_family(false));
}

}  // namespace edged
