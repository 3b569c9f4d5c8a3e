// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "contact_sheet.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "drawing.hpp"

namespace edged {
namespace {

constexpr int kGap = 14, kCellWidth = 400, kCaption = 22, kTitleLine = 24;

int scaled_height(const cv::Mat& image) {
  return image.empty() ? 0 : cvRound(1.0 * kCellWidth * image.rows / image.cols);
}

int row_height(const SheetRow& row) {
  int height = 0;
  for (const SheetCell& cell : row) height = std::max(height, scaled_height(cell.image));
  return kCaption + height + kGap;
}

void draw_cell(cv::Mat& canvas, const SheetCell& cell, cv::Point at) {
  if (cell.image.empty()) return;
  put_text(canvas, cell.caption, at + cv::Point(0, kCaption - 7), 0.45);
  cv::Mat colour, sized;
  cv::cvtColor(cell.image, colour, cv::COLOR_GRAY2BGR);
  const cv::Size size(kCellWidth, scaled_height(cell.image));
  cv::resize(colour, sized, size, 0, 0, size.width < colour.cols ? cv::INTER_AREA : cv::INTER_NEAREST);
  sized.copyTo(canvas(cv::Rect(at + cv::Point(0, kCaption), size)));
}

}  // namespace

cv::Mat draw_contact_sheet(const std::vector<std::string>& title, const std::vector<SheetRow>& rows) {
  std::size_t columns = 1;
  int height = kGap + kTitleLine * static_cast<int>(title.size());
  for (const SheetRow& row : rows) columns = std::max(columns, row.size()), height += row_height(row);
  const int width = kGap + static_cast<int>(columns) * (kCellWidth + kGap);
  cv::Mat canvas(height, width, CV_8UC3, kPaper);
  int y = kGap;
  for (const std::string& line : title) put_text(canvas, line, {kGap, y + 14}, 0.5), y += kTitleLine;
  for (const SheetRow& row : rows) {
    int x = kGap;
    for (const SheetCell& cell : row) draw_cell(canvas, cell, {x, y}), x += kCellWidth + kGap;
    y += row_height(row);
  }
  return canvas;
}

}  // namespace edged
