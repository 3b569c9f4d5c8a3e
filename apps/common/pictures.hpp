// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Common parts of the output images: colours, text, thumbnails with tracks, sheets of many images.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "edged/track.hpp"

namespace edged {

inline const cv::Scalar kPaper(255, 255, 255), kInk(60, 50, 40);  // blue, green, red

inline void put_text(cv::Mat& canvas, const std::string& text, cv::Point at, double size = 0.45,
                     const cv::Scalar& ink = kInk) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, size, ink, 1, cv::LINE_AA);
}

/// A JPEG, at most widest_px wide, with each track and its previous position. `image` is not modified.
std::vector<unsigned char> track_picture(const cv::Mat& image, const std::vector<Track>& tracks, int widest_px);

struct SheetCell {
  std::string caption;
  cv::Mat image;  ///< CV_8UC1; empty: the cell stays blank
};

using SheetRow = std::vector<SheetCell>;

/// CV_8UC3, with the lines of the title on top. Each image is scaled to the width of its cell.
cv::Mat draw_contact_sheet(const std::vector<std::string>& title, const std::vector<SheetRow>& rows);

}  // namespace edged
