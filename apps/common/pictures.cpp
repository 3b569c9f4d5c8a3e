// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/pictures.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "edged/io/parse/image_codec.hpp"

namespace edged {
namespace {

constexpr int kQuality = 70;  // of JPEG
const cv::Scalar kTrackColour(60, 200, 60), kNewTrackColour(60, 160, 255);

constexpr int kGapWidth_px = 14, kCellWidth = 400, kCaption = 22, kTitleLine = 24;

int scaled_height(const cv::Mat& image) {
  return image.empty() ? 0 : cvRound(1.0 * kCellWidth * image.rows / image.cols);
}

int row_height(const SheetRow& row) {
  int height = 0;
  for (const SheetCell& cell : row) height = std::max(height, scaled_height(cell.image));
  return kCaption + height + kGapWidth_px;
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

std::vector<unsigned char> track_picture(const cv::Mat& image, const std::vector<Track>& tracks, int widest_px) {
  const double scale = std::min(1.0, static_cast<double>(widest_px) / image.cols);
  cv::Mat sized, colour;
  cv::resize(image, sized, {}, scale, scale, cv::INTER_AREA);
  if (sized.depth() != CV_8U) sized.convertTo(sized, CV_8U, 1.0 / 256.0);
  if (sized.channels() == 1) {
    cv::cvtColor(sized, colour, cv::COLOR_GRAY2BGR);
  } else {
    colour = sized.clone();
  }
  for (const Track& track : tracks) {
    const cv::Point2d now(scale * track.pixel.x(), scale * track.pixel.y());
    const cv::Point2d before(scale * track.previous_pixel.x(), scale * track.previous_pixel.y());
    const cv::Scalar& ink = track.age > 5 ? kTrackColour : kNewTrackColour;
    if (track.age > 0) cv::line(colour, before, now, ink, 1, cv::LINE_AA);
    cv::circle(colour, now, 2, ink, 1, cv::LINE_AA);
  }
  return encode_jpeg(colour, kQuality);
}

cv::Mat draw_contact_sheet(const std::vector<std::string>& title, const std::vector<SheetRow>& rows) {
  std::size_t columns = 1;
  int height = kGapWidth_px + kTitleLine * static_cast<int>(title.size());
  for (const SheetRow& row : rows) columns = std::max(columns, row.size()), height += row_height(row);
  const int width = kGapWidth_px + static_cast<int>(columns) * (kCellWidth + kGapWidth_px);
  cv::Mat canvas(height, width, CV_8UC3, kPaper);
  int y = kGapWidth_px;
  for (const std::string& line : title) put_text(canvas, line, {kGapWidth_px, y + 14}, 0.5), y += kTitleLine;
  for (const SheetRow& row : rows) {
    int x = kGapWidth_px;
    for (const SheetCell& cell : row) draw_cell(canvas, cell, {x, y}), x += kCellWidth + kGapWidth_px;
    y += row_height(row);
  }
  return canvas;
}

}  // namespace edged
