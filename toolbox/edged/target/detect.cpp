// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/target/detect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/target/dictionaries.hpp"

namespace edged {
namespace {

using Quad = std::vector<cv::Point2f>;

// Pictures narrower than this are searched at twice their size, those of half of it at three times: a bit of a tag has
// few pixels there.
constexpr int kSmallPicture_px = 800;
constexpr double kSmallestTag_px = 12.0;  // its side
constexpr std::size_t kFewestTags = 2;    // of one alone the orientation is not certain
// Largest distance of a corner from the plane through the others, as a share of the picture: distortion bends it.
constexpr double kBend = 0.08;

// Half size of the window in which a corner is refined, over the distance of what else lies there. The blur of the bits
// within a tag reaches 1.5 px towards it, and pulls the corner.
constexpr double kWindow = 0.8;

/// How much larger a picture is searched.
float enlargement(const cv::Mat& picture) {
  const int side = std::max(picture.cols, picture.rows);
  return side < kSmallPicture_px / 2 ? 3.0F : side < kSmallPicture_px ? 2.0F : 1.0F;
}

cv::Mat enlarged(const cv::Mat& picture, float factor) {
  if (factor == 1.0F) return picture;
  cv::Mat out;
  cv::resize(picture, out, {}, factor, factor, cv::INTER_CUBIC);
  return out;
}

void scale_back(Quad& points, float factor) {
  const cv::Point2f half(0.5F, 0.5F);
  for (cv::Point2f& p : points) p = (p + half) / factor - half;
}

/// The first tags of their family. As they are few, five wrong bits of the AprilTags' 36 are safely corrected (their
/// distance is 11 bits); OpenCV by itself corrects none of this family.
cv::Ptr<cv::aruco::Dictionary> tags_of(const TargetSpec& spec, std::size_t count) {
  const auto family = tag_family(spec.kind == TargetKind::AprilGrid);
  if (spec.kind != TargetKind::AprilGrid) return family;
  return cv::makePtr<cv::aruco::Dictionary>(family->bytesList.rowRange(0, static_cast<int>(count)), family->markerSize,
                                            5);
}

cv::Ptr<cv::aruco::DetectorParameters> tag_parameters(TargetKind kind, const cv::Mat& picture) {
  auto parameters = cv::makePtr<cv::aruco::DetectorParameters>();
  parameters->markerBorderBits = border_bits(kind == TargetKind::AprilGrid);
  parameters->minMarkerPerimeterRate = 4.0 * kSmallestTag_px / std::max(picture.cols, picture.rows);
  parameters->adaptiveThreshWinSizeMax = 33;
  parameters->adaptiveThreshConstant = 8.0;
  parameters->perspectiveRemoveIgnoredMarginPerCell = 0.3;
  parameters->errorCorrectionRate = 1.0;
  parameters->minDistanceToBorder = 1;
  return parameters;
}

/// Tags by their number. The squares in the gaps of an AprilGrid touch the tags, so that their outlines are one. Where
/// the bright parts are widened by a pixel or two, they are apart.
std::map<int, Quad> find_tags(const cv::Mat& picture, const TargetSpec& spec, std::size_t count) {
  const float factor = enlargement(picture);
  const cv::Mat searched = enlarged(picture, factor);
  const auto family = tags_of(spec, count);
  std::map<int, Quad> out;
  for (const int widened : {1, 3}) {
    cv::Mat at = searched;
    if (widened > 1) cv::dilate(searched, at, cv::Mat::ones(widened, widened, CV_8U));
    std::vector<Quad> quads;
    std::vector<int> ids;
    cv::aruco::detectMarkers(at, family, quads, ids, tag_parameters(spec.kind, searched));
    for (std::size_t i = 0; i < ids.size(); ++i) {
      scale_back(quads[i], factor);
      out.emplace(ids[i], quads[i]);
    }
    if (spec.kind == TargetKind::Charuco) break;
  }
  return out;
}

double side_px(const Quad& quad) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) shortest = std::min(shortest, cv::norm(quad[i] - quad[(i + 1) % 4]));
  return shortest;
}

cv::Point2f to_cv(const Eigen::Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }

/// A corner before it is refined, and the half size of the window around it in which nothing else is.
struct RoughCorner {
  int id;
  cv::Point2f pixel;
  double window_px;
};

/// Where dark meets dark across a corner, to a fraction of a pixel. What moves out of its window is dropped.
std::vector<TargetCorner> refine(const cv::Mat& picture, const std::vector<RoughCorner>& rough) {
  constexpr double kSmallest_px = 1.5, kLargest_px = 6.0, kMoved_px = 1.5;
  std::vector<TargetCorner> out;
  for (const RoughCorner& corner : rough) {
    if (corner.window_px < kSmallest_px) continue;
    const int half = static_cast<int>(std::lround(std::clamp(corner.window_px, 2.0, kLargest_px)));
    const auto inside = [&](const cv::Point2f& p) {
      const float border = static_cast<float>(half) + 1.0F;
      return p.x >= border && p.y >= border && p.x <= static_cast<float>(picture.cols - 1) - border &&
             p.y <= static_cast<float>(picture.rows - 1) - border;
    };
    if (!inside(corner.pixel)) continue;
    std::vector<cv::Point2f> refined{corner.pixel};
    cv::cornerSubPix(picture, refined, {half, half}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3});
    if (cv::norm(refined[0] - corner.pixel) > half + kMoved_px || !inside(refined[0])) continue;
    out.push_back({corner.id, {refined[0].x, refined[0].y}});
  }
  return out;
}

/// Corners of an AprilGrid by their number, from the tags that were read to those beside them that were not.
class GridCompletion {
 public:
  GridCompletion(const cv::Mat& picture, const TargetSpec& spec, const TargetLayout& layout)
      : picture_(picture), spec_(spec), layout_(layout), placed_(layout.tags.size(), false) {}

  void add(int tag, const std::vector<TargetCorner>& corners) {
    placed_[static_cast<std::size_t>(tag)] = true;
    for (const TargetCorner& corner : corners) corners_[corner.id] = corner.pixel;
  }

  /// Goes on until no tag beside a known one is found.
  void complete() {
    for (bool found = true; found;) {
      found = false;
      for (int tag = 0; tag < static_cast<int>(placed_.size()); ++tag) {
        if (placed_[static_cast<std::size_t>(tag)]) continue;
        for (const int beside : neighbours(tag))
          if (placed_[static_cast<std::size_t>(beside)] && try_from(beside, tag)) {
            found = true;
            break;
          }
      }
    }
  }

  const std::map<int, Eigen::Vector2d>& corners() const { return corners_; }

 private:
  std::vector<int> neighbours(int tag) const {
    const int row = tag / spec_.columns, column = tag % spec_.columns;
    std::vector<int> out;
    if (column > 0) out.push_back(tag - 1);
    if (column + 1 < spec_.columns) out.push_back(tag + 1);
    if (row > 0) out.push_back(tag - spec_.columns);
    if (row + 1 < spec_.rows) out.push_back(tag + spec_.columns);
    return out;
  }

  bool try_from(int known, int tag) {
    std::vector<cv::Point2f> plane, pixels;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto at = corners_.find(4 * known + static_cast<int>(k));
      if (at == corners_.end()) return false;
      plane.push_back(to_cv(layout_.tags[static_cast<std::size_t>(known)].corners.at(k)));
      pixels.push_back(to_cv(at->second));
    }
    const cv::Mat H = cv::getPerspectiveTransform(plane, pixels);
    const auto place = [&H](const Eigen::Vector2d& p) {
      std::vector<cv::Point2f> from{to_cv(p)}, to;
      cv::perspectiveTransform(from, to, H);
      return to[0];
    };
    const auto& corners = layout_.tags[static_cast<std::size_t>(tag)].corners;
    Quad quad;
    for (const Eigen::Vector2d& corner : corners) quad.push_back(place(corner));
    const double side = side_px(quad);
    if (side < kSmallestTag_px) return false;
    std::vector<RoughCorner> rough;
    for (std::size_t k = 0; k < 4; ++k)
      rough.push_back({4 * tag + static_cast<int>(k), quad[k], kWindow * std::min(0.2, spec_.ratio) * side});
    std::map<int, Eigen::Vector2d> found;
    for (const TargetCorner& corner : refine(picture_, rough)) {
      const auto k = static_cast<std::size_t>(corner.id % 4);
      const bool near = cv::norm(to_cv(corner.pixel) - quad[k]) < std::max(1.5, 0.12 * side);
      if (near && is_saddle(corners.at(k), corners.at((k + 2) % 4), corner.pixel, quad[k], place))
        found[corner.id] = corner.pixel;
    }
    if (found.size() < 2) return false;
    corners_.insert(found.begin(), found.end());
    placed_[static_cast<std::size_t>(tag)] = true;
    return true;
  }

  /// Dark towards the middle of the tag and across, bright to both sides.
  template <typename Place>
  bool is_saddle(const Eigen::Vector2d& corner, const Eigen::Vector2d& opposite, const Eigen::Vector2d& pixel,
                 const cv::Point2f& expected, const Place& place) const {
    constexpr int kLeastContrast = 12;
    const Eigen::Vector2d inwards = 0.5 * std::min(0.2, spec_.ratio) * (opposite - corner);
    const auto level = [&](double x, double y) {
      const cv::Point2f p = place(corner + Eigen::Vector2d(x * inwards.x(), y * inwards.y())) - expected + to_cv(pixel);
      const int column = static_cast<int>(std::lround(p.x)), row = static_cast<int>(std::lround(p.y));
      const bool inside = column >= 0 && row >= 0 && column < picture_.cols && row < picture_.rows;
      return inside ? static_cast<int>(picture_.at<std::uint8_t>(row, column)) : -1;
    };
    const int a = level(1, 1), b = level(-1, -1), c = level(1, -1), d = level(-1, 1);
    return std::min({a, b, c, d}) >= 0 && std::min(c, d) - std::max(a, b) > kLeastContrast;
  }

  const cv::Mat& picture_;
  const TargetSpec& spec_;
  const TargetLayout& layout_;
  std::vector<bool> placed_;  // by tag
  std::map<int, Eigen::Vector2d> corners_;
};

/// Tags of an AprilGrid printed by different programs are turned by quarters. Corner k of a found tag is corner k +
/// turn of the layout.
struct GridFit {
  std::size_t turn = 0;
  std::vector<bool> fits;  // by tag
  std::size_t count = 0;
};

GridFit fit_grid(const TargetLayout& layout, const std::vector<std::pair<int, Quad>>& tags, double tolerance_px) {
  GridFit best;
  double best_error = std::numeric_limits<double>::infinity();
  for (std::size_t turn = 0; turn < 4; ++turn) {
    std::vector<cv::Point2f> plane, pixels;
    for (const auto& [id, quad] : tags)
      for (std::size_t k = 0; k < 4; ++k) {
        plane.push_back(to_cv(layout.tags[static_cast<std::size_t>(id)].corners.at((k + turn) % 4)));
        pixels.push_back(quad[k]);
      }
    const cv::Mat H = cv::findHomography(plane, pixels, cv::LMEDS);
    if (H.empty()) continue;
    std::vector<cv::Point2f> expected;
    cv::perspectiveTransform(plane, expected, H);
    GridFit fit{turn, std::vector<bool>(tags.size(), false), 0};
    std::vector<double> errors;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      double worst = 0.0;
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
        errors.push_back(cv::norm(expected[k] - pixels[k]));
        worst = std::max(worst, errors.back());
      }
      fit.fits[i] = worst < tolerance_px;
      fit.count += fit.fits[i] ? 1 : 0;
    }
    const double error = median(errors);
    if (error < best_error) best = fit, best_error = error;
  }
  return best;
}

}  // namespace

TargetDetector::TargetDetector(const TargetSpec& spec) : spec_(spec), layout_(layout_of(spec)) {}

std::vector<TargetCorner> TargetDetector::detect(const cv::Mat& picture) const {
  EDGED_CHECK(picture.type() == CV_8UC1, "a picture of type {}", picture.type());
  switch (spec_.kind) {
    case TargetKind::Checkerboard:
      return checkerboard(picture);
    case TargetKind::Charuco:
      return charuco(picture);
    case TargetKind::AprilGrid:
      break;
  }
  return april_grid(picture);
}

std::vector<TargetCorner> TargetDetector::april_grid(const cv::Mat& picture) const {
  std::vector<std::pair<int, Quad>> tags;
  for (const auto& [id, quad] : find_tags(picture, spec_, layout_.tags.size()))
    if (id < static_cast<int>(layout_.tags.size()) && side_px(quad) >= kSmallestTag_px) tags.emplace_back(id, quad);
  if (tags.size() < kFewestTags) return {};
  const GridFit fit = fit_grid(layout_, tags, kBend * std::max(picture.cols, picture.rows));
  if (fit.count < kFewestTags) return {};
  GridCompletion grid(picture, spec_, layout_);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!fit.fits[i]) continue;
    const auto& [id, quad] = tags[i];
    // The border of a tag is two bits of ten wide, the gap about as much.
    const double window = kWindow * std::min(0.2, spec_.ratio) * side_px(quad);
    std::vector<RoughCorner> rough;
    for (std::size_t k = 0; k < 4; ++k)
      rough.push_back({4 * id + static_cast<int>((k + fit.turn) % 4), quad[k], window});
    grid.add(id, refine(picture, rough));
  }
  grid.complete();
  std::vector<TargetCorner> out;
  for (const auto& [id, pixel] : grid.corners()) out.push_back({id, pixel});
  return out;
}

std::vector<TargetCorner> TargetDetector::charuco(const cv::Mat& picture) const {
  std::vector<Quad> quads;
  std::vector<int> ids;
  double shortest = std::numeric_limits<double>::infinity();
  for (auto& [id, quad] : find_tags(picture, spec_, layout_.tags.size())) {
    shortest = std::min(shortest, side_px(quad));
    ids.push_back(id);
    quads.push_back(quad);
  }
  if (ids.size() < kFewestTags) return {};
  std::vector<cv::Point2f> pixels;
  std::vector<int> corners;
  cv::aruco::interpolateCornersCharuco(quads, ids, picture, charuco_board(spec_.columns, spec_.rows, spec_.ratio),
                                       pixels, corners);
  const double window = 0.45 * (1.0 - spec_.ratio) * shortest / spec_.ratio;  // to the nearest marker
  std::vector<RoughCorner> rough;
  for (std::size_t i = 0; i < corners.size(); ++i) rough.push_back({corners[i], pixels[i], window});
  return refine(picture, rough);
}

std::vector<TargetCorner> TargetDetector::checkerboard(const cv::Mat& picture) const {
  const float factor = enlargement(picture);
  Quad found;
  if (!cv::findChessboardCornersSB(enlarged(picture, factor), {spec_.columns, spec_.rows}, found,
                                   cv::CALIB_CB_NORMALIZE_IMAGE))
    return {};
  scale_back(found, factor);
  const auto columns = static_cast<std::size_t>(spec_.columns), rows = static_cast<std::size_t>(spec_.rows);
  const auto at = [&](std::size_t row, std::size_t column) -> cv::Point2f& { return found[row * columns + column]; };
  // y of the target points up, y of the picture down.
  const cv::Point2f across = at(0, columns - 1) - at(0, 0), along = at(rows - 1, 0) - at(0, 0);
  if (across.cross(along) > 0.0F)
    for (std::size_t row = 0; row < rows / 2; ++row)
      for (std::size_t column = 0; column < columns; ++column) std::swap(at(row, column), at(rows - 1 - row, column));
  double dark_less_bright = 0.0, shortest = std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row + 1 < rows; ++row)
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      const cv::Point2f middle =
          0.25F * (at(row, column) + at(row + 1, column) + at(row, column + 1) + at(row + 1, column + 1));
      const int level =
          picture.at<std::uint8_t>(std::clamp(static_cast<int>(std::lround(middle.y)), 0, picture.rows - 1),
                                   std::clamp(static_cast<int>(std::lround(middle.x)), 0, picture.cols - 1));
      dark_less_bright += (row + column) % 2 == 0 ? level : -level;
      shortest = std::min(
          {shortest, cv::norm(at(row, column) - at(row + 1, column)), cv::norm(at(row, column) - at(row, column + 1))});
    }
  if (dark_less_bright > 0.0) std::ranges::reverse(found);
  std::vector<RoughCorner> rough;
  for (std::size_t i = 0; i < found.size(); ++i) rough.push_back({static_cast<int>(i), found[i], 0.4 * shortest});
  return refine(picture, rough);
}

}  // namespace edged
