// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the pictures of this program share: colours and lettering.
#pragma once

#include <opencv2/imgproc.hpp>
#include <string>

namespace edged {

inline const cv::Scalar kPaper(255, 255, 255), kInk(60, 50, 40);  // blue, green, red

inline void put_text(cv::Mat& canvas, const std::string& text, cv::Point at, double size = 0.45,
                     const cv::Scalar& ink = kInk) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, size, ink, 1, cv::LINE_AA);
}

}  // namespace edged
