// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Labelled images in rows on one page.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace edged {

struct SheetCell {
  std::string caption;
  cv::Mat image;  ///< CV_8UC1; empty: the cell stays blank
};

using SheetRow = std::vector<SheetCell>;

/// CV_8UC3, with the title's lines on top. Every image is scaled to the width of its cell.
cv::Mat draw_contact_sheet(const std::vector<std::string>& title, const std::vector<SheetRow>& rows);

}  // namespace edged
