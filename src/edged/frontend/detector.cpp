// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corner detection on a grid.
#include "edged/frontend/detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "edged/core/check.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

constexpr double kLevelFactor = 1.2;  // between scales, as ORB
constexpr int kHarrisHalf = 3;        // 7x7 block, as ORB
constexpr double kHarrisK = 0.04;
constexpr int kFastRadius = 3;
constexpr int kShiTomasiBlock = 5;
constexpr int kRefinementHalf = 3;

struct Candidate {
  int cell = 0;
  int x = 0, y = 0;
  double response = 0.0;
};

// Strongest first; ties by position, so that the order never depends on the sort.
bool stronger(const Candidate& a, const Candidate& b) {
  return std::tuple(-a.response, a.y, a.x) < std::tuple(-b.response, b.y, b.x);
}

class Grid {
 public:
  Grid(const cv::Size& size, double cell_px)
      : columns_(std::max(1, static_cast<int>(std::lround(size.width / cell_px)))),
        rows_(std::max(1, static_cast<int>(std::lround(size.height / cell_px)))),
        size_(size),
        taken_(static_cast<std::size_t>(columns_ * rows_), false) {}

  int count() const { return columns_ * rows_; }
  bool taken(int cell) const { return taken_[static_cast<std::size_t>(cell)]; }
  void take(int cell) { taken_[static_cast<std::size_t>(cell)] = true; }

  /// Every pixel belongs to exactly one cell; cells differ by at most one pixel in size.
  cv::Rect rectangle(int cell) const {
    const int column = cell % columns_, row = cell / columns_;
    const int x0 = first(column, columns_, size_.width), y0 = first(row, rows_, size_.height);
    return {x0, y0, first(column + 1, columns_, size_.width) - x0, first(row + 1, rows_, size_.height) - y0};
  }

  int cell_at(int x, int y) const { return index(y, rows_, size_.height) * columns_ + index(x, columns_, size_.width); }

 private:
  static int first(int i, int cells, int length) { return (i * length + cells - 1) / cells; }
  static int index(int position, int cells, int length) { return position * cells / length; }

  int columns_, rows_;
  cv::Size size_;
  std::vector<bool> taken_;
};

// Harris score of a 7x7 block of central differences.
double harris_response(const cv::Mat& image, int x, int y) {
  double xx = 0, yy = 0, xy = 0;
  for (int v = y - kHarrisHalf; v <= y + kHarrisHalf; ++v) {
    const auto* above = image.ptr<uchar>(v - 1);
    const auto* row = image.ptr<uchar>(v);
    const auto* below = image.ptr<uchar>(v + 1);
    for (int u = x - kHarrisHalf; u <= x + kHarrisHalf; ++u) {
      const int gx = row[u + 1] - row[u - 1], gy = below[u] - above[u];
      xx += gx * gx, yy += gy * gy, xy += gx * gy;
    }
  }
  return xx * yy - xy * xy - kHarrisK * (xx + yy) * (xx + yy);
}

// The highest threshold at which the pixel is still a FAST-9 corner: nine neighbours in a row on the circle that are
// all brighter, or all darker, by at least that.
double fast_response(const cv::Mat& image, int x, int y) {
  constexpr int kCircle = 16, kArc = 9;
  constexpr std::array<int, kCircle> kX{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<int, kCircle> kY{-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  std::array<int, kCircle> brighter{};
  for (std::size_t i = 0; i < kCircle; ++i) brighter[i] = image.at<uchar>(y + kY[i], x + kX[i]) - image.at<uchar>(y, x);
  int best = 0;
  for (std::size_t first = 0; first < kCircle; ++first) {
    int least = 255, most = -255;
    for (std::size_t i = 0; i < kArc; ++i) {
      const int difference = brighter[(first + i) % kCircle];
      least = std::min(least, difference), most = std::max(most, difference);
    }
    best = std::max({best, least, -most});
  }
  return best;
}

std::vector<Candidate> fast_corners(const cv::Mat& image, const cv::Rect& cell, int threshold, CornerKind kind) {
  const cv::Rect area(cell.x - kFastRadius, cell.y - kFastRadius, cell.width + 2 * kFastRadius,
                      cell.height + 2 * kFastRadius);
  // No suppression of neighbours: event frames have few grey levels, and FAST drops both of two equal corners.
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(image(area), keypoints, threshold, false);
  std::vector<Candidate> found;
  found.reserve(keypoints.size());
  for (const cv::KeyPoint& k : keypoints) {
    const int x = cvRound(k.pt.x) + area.x, y = cvRound(k.pt.y) + area.y;
    found.push_back({0, x, y, kind == CornerKind::Fast ? fast_response(image, x, y) : harris_response(image, x, y)});
  }
  return found;
}

std::vector<Candidate> shi_tomasi_corners(const cv::Mat& image, const cv::Rect& cell, double min_gradient) {
  const cv::Rect area(cell.x - 1, cell.y - 1, cell.width + 2, cell.height + 2);
  cv::Mat response, largest;
  cv::cornerMinEigenVal(image(area), response, kShiTomasiBlock, 3);
  cv::dilate(response, largest, cv::Mat());  // the largest of the 3x3 neighbourhood
  // In OpenCV's scale a slope of g grey levels per pixel all over the block gives (2 g / 255)^2.
  const double floor = std::pow(2.0 * min_gradient / 255.0, 2);
  std::vector<Candidate> found;
  for (int y = 1; y + 1 < response.rows; ++y) {
    for (int x = 1; x + 1 < response.cols; ++x) {
      const float value = response.at<float>(y, x);
      if (value < floor || value < largest.at<float>(y, x)) continue;
      found.push_back({0, x + area.x, y + area.y, value});
    }
  }
  return found;
}

std::vector<Candidate> corners_in(const cv::Mat& image, const cv::Rect& cell, const DetectorConfig& config) {
  if (config.corners == CornerKind::ShiTomasi) return shi_tomasi_corners(image, cell, config.min_gradient);
  std::vector<Candidate> found = fast_corners(image, cell, config.fast_threshold, config.corners);
  if (found.empty()) found = fast_corners(image, cell, config.fast_threshold_low, config.corners);
  std::erase_if(found, [](const Candidate& c) { return c.response <= 0.0; });  // on an edge, not at a corner
  return found;
}

std::vector<Candidate> strongest_apart(std::vector<Candidate> found) {
  std::sort(found.begin(), found.end(), stronger);
  std::vector<Candidate> kept;
  for (const Candidate& c : found) {
    const auto same_corner = [&](const Candidate& k) {
      return std::max(std::abs(c.x - k.x), std::abs(c.y - k.y)) < kFrontendTuning.same_corner_px;
    };
    if (std::none_of(kept.begin(), kept.end(), same_corner)) kept.push_back(c);
    if (kept.size() == kFrontendTuning.candidates_per_cell) break;
  }
  return kept;
}

/// The image at one scale; factor: its pixels in pixels of the image itself.
struct Scale {
  cv::Mat image;
  double factor = 1.0;
};

std::vector<Scale> scales_of(const cv::Mat& image, int levels) {
  std::vector<Scale> scales{{image, 1.0}};
  for (int level = 1; level < levels; ++level) {
    const double factor = scales.back().factor * kLevelFactor;
    cv::Mat smaller;
    const cv::Size size(cvRound(image.cols / factor), cvRound(image.rows / factor));
    if (size.empty()) break;
    cv::resize(scales.back().image, smaller, size, 0, 0, cv::INTER_LINEAR_EXACT);
    scales.push_back({smaller, factor});
  }
  return scales;
}

/// The corners of all scales in a cell, in pixels of the image. On a smooth corner the Harris score grows with the
/// scale's factor to the fourth, as a scale-normalised one does: the scores compare.
std::vector<Candidate> corners_at(const std::vector<Scale>& scales, const cv::Rect& cell,
                                  const DetectorConfig& config) {
  std::vector<Candidate> found = corners_in(scales.front().image, cell, config);
  constexpr int kBorder = kHarrisHalf + 2;
  for (std::size_t level = 1; level < scales.size(); ++level) {
    const auto& [image, factor] = scales[level];
    const cv::Point first(cvCeil(cell.x / factor), cvCeil(cell.y / factor));
    const cv::Point end(cvCeil(cell.br().x / factor), cvCeil(cell.br().y / factor));
    const cv::Rect inner(kBorder, kBorder, image.cols - 2 * kBorder, image.rows - 2 * kBorder);
    if (inner.width <= 0 || inner.height <= 0) break;
    const cv::Rect visible = cv::Rect(first, end) & inner;
    if (visible.empty()) continue;
    for (Candidate& c : corners_in(image, visible, config)) {
      c.x = std::clamp(cvRound((c.x + 0.5) * factor - 0.5), cell.x, cell.br().x - 1);
      c.y = std::clamp(cvRound((c.y + 0.5) * factor - 0.5), cell.y, cell.br().y - 1);
      found.push_back(c);
    }
  }
  return found;
}

std::vector<Candidate> candidates(const cv::Mat& image, const Grid& grid, const cv::Rect& inner,
                                  const DetectorConfig& config) {
  const std::vector<Scale> scales = scales_of(image, config.levels);
  std::vector<Candidate> all;
  for (int cell = 0; cell < grid.count(); ++cell) {
    const cv::Rect visible = grid.rectangle(cell) & inner;
    if (grid.taken(cell) || visible.empty()) continue;
    for (Candidate& c : strongest_apart(corners_at(scales, visible, config))) c.cell = cell, all.push_back(c);
  }
  std::sort(all.begin(), all.end(), stronger);
  return all;
}

void refine_positions(const cv::Mat& image, std::vector<Corner>& corners) {
  if (corners.empty()) return;
  std::vector<cv::Point2f> points;
  for (const Corner& c : corners) points.emplace_back(static_cast<float>(c.pixel.x()), static_cast<float>(c.pixel.y()));
  cv::cornerSubPix(image, points, cv::Size(kRefinementHalf, kRefinementHalf), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.02));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d refined(points[i].x, points[i].y);
    // Further away it is another corner.
    if ((refined - corners[i].pixel).cwiseAbs().maxCoeff() < kRefinementHalf) corners[i].pixel = refined;
  }
}

}  // namespace

void DetectorConfig::visit(ConfigFields& fields) {
  fields.choice(
      "corners", corners,
      {{"fast_harris", CornerKind::FastHarris}, {"fast", CornerKind::Fast}, {"shi_tomasi", CornerKind::ShiTomasi}},
      {.effect = "Corner detector: FAST ranked by Harris score (as in ORB), FAST by its own score, or Shi-Tomasi."});
  fields.add("max_features", max_features,
             {"1", 8, 2000, "Largest number of live tracks per camera, one per grid cell."});
  fields.add("cell_px", cell_px,
             {"px", 6, 120, "Side length of a grid cell in an image 240 px wide. It scales with the width."});
  fields.add("levels", levels, {"1", 1, 8, "Number of scales for detection, each 1.2 times coarser (as in ORB)."});
  fields.add(
      "separation_px", separation_px,
      {"px", 0, 60, "Least distance of a new feature from a track in an image 240 px wide. It scales with the width."});
  fields.add("fast_threshold", fast_threshold,
             {"grey", 2, 200, "Contrast threshold of FAST, used first in every cell."});
  fields.add("fast_threshold_low", fast_threshold_low,
             {"grey", 1, 200, "Contrast threshold of FAST in cells without a corner at the first threshold."});
}

std::vector<Corner> detect_corners(const cv::Mat& image, std::span<const Eigen::Vector2d> occupied, int limit,
                                   const DetectorConfig& config, const cv::Mat& unused) {
  EDGED_CHECK(image.empty() || image.type() == CV_8UC1, "image type {}", image.type());
  const int border = std::max(config.border_px, kHarrisHalf + 2);
  const cv::Rect inner(border, border, image.cols - 2 * border, image.rows - 2 * border);
  if (limit <= 0 || inner.width <= 0 || inner.height <= 0) return {};

  const double scale = image.cols / kFrontendTuning.reference_width_px;
  Grid grid(image.size(), config.cell_px * scale);
  cv::Mat near_track = unused.empty() ? cv::Mat(cv::Mat::zeros(image.size(), CV_8UC1)) : unused.clone();
  const auto occupy = [&](const cv::Point& p) {
    cv::circle(near_track, p, cvRound(config.separation_px * scale), cv::Scalar(255), cv::FILLED);
    grid.take(grid.cell_at(p.x, p.y));
  };
  for (const Eigen::Vector2d& pixel : occupied) {
    const cv::Point p(cvRound(pixel.x()), cvRound(pixel.y()));
    if (p.inside(cv::Rect(cv::Point(), image.size()))) occupy(p);
  }

  std::vector<Corner> corners;
  for (const Candidate& c : candidates(image, grid, inner, config)) {
    if (static_cast<int>(corners.size()) == limit) break;
    if (grid.taken(c.cell) || near_track.at<uchar>(c.y, c.x) != 0) continue;
    corners.push_back({Eigen::Vector2d(c.x, c.y), c.response});
    occupy({c.x, c.y});
  }
  if (config.subpixel) refine_positions(image, corners);
  return corners;
}

}  // namespace edged
