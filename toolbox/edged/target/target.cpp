// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/target/target.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/target/dictionaries.hpp"

namespace edged {
namespace {

using Eigen::Vector2d;

constexpr int kMostLines = 40;

TargetPatch patch(double x, double y, double width, double height) {
  return {Vector2d(x, y), Vector2d(x + width, y + height)};
}

/// The dark bits of a tag, of which each row of dark ones is one patch.
void add_bits(TargetLayout& layout, const TargetTag& tag, bool april) {
  const auto family = tag_family(april);
  const int side = family->markerSize + 2 * border_bits(april);
  cv::Mat bits;
  draw_marker(*family, tag.id, side, bits, border_bits(april));
  const Vector2d right = (tag.corners[1] - tag.corners[0]) / side, down = (tag.corners[3] - tag.corners[0]) / side;
  for (int row = 0; row < side; ++row)
    for (int first = 0, end = 0; first < side; first = end + 1) {
      for (end = first; end < side && bits.at<std::uint8_t>(row, end) == 0;) ++end;
      if (end == first) continue;
      const Vector2d a = tag.corners[0] + first * right + row * down, b = a + (end - first) * right + down;
      layout.dark.push_back({a.cwiseMin(b), a.cwiseMax(b)});
    }
}

TargetLayout checkerboard(const TargetSpec& spec) {
  TargetLayout out;
  const double a = spec.size_m;
  out.width = (spec.columns + 1) * a, out.height = (spec.rows + 1) * a, out.margin = a;
  for (int row = 0; row < spec.rows; ++row)
    for (int column = 0; column < spec.columns; ++column) out.corners.emplace_back((column + 1) * a, (row + 1) * a);
  for (int row = 0; row <= spec.rows; ++row)
    for (int column = row % 2; column <= spec.columns; column += 2)
      out.dark.push_back(patch(column * a, row * a, a, a));
  return out;
}

TargetLayout april_grid(const TargetSpec& spec) {
  TargetLayout out;
  const double a = spec.size_m, gap = spec.ratio * a, pitch = a + gap;
  out.width = spec.columns * pitch + gap, out.height = spec.rows * pitch + gap, out.margin = gap;
  for (int row = 0; row < spec.rows; ++row)
    for (int column = 0; column < spec.columns; ++column) {
      const Vector2d low(gap + column * pitch, gap + row * pitch), high = low + Vector2d(a, a);
      const std::array<Vector2d, 4> corners{Vector2d(low.x(), high.y()), high, Vector2d(high.x(), low.y()), low};
      out.corners.insert(out.corners.end(), corners.begin(), corners.end());
      out.tags.push_back({row * spec.columns + column, corners});
      add_bits(out, out.tags.back(), true);
    }
  for (int row = 0; row <= spec.rows; ++row)
    for (int column = 0; column <= spec.columns; ++column)
      out.dark.push_back(patch(column * pitch, row * pitch, gap, gap));
  return out;
}

TargetLayout charuco(const TargetSpec& spec) {
  TargetLayout out;
  const double a = spec.size_m;
  out.width = spec.columns * a, out.height = spec.rows * a, out.margin = 0.5 * a;
  const BoardPoints board = points_of(*charuco_board(spec.columns, spec.rows, spec.ratio));
  // Versions of OpenCV differ in the direction of y. Seen from the front, a tag's corners run clockwise.
  const auto& first = board.markers.at(0);
  const bool y_down = (first[1] - first[0]).cross(first[3] - first[0]).z > 0.0F;
  const auto place = [&](const cv::Point3f& p) {
    return Vector2d(a * p.x, y_down ? out.height - a * p.y : a * static_cast<double>(p.y));
  };
  std::vector<bool> white(static_cast<std::size_t>(spec.rows * spec.columns), false);
  for (std::size_t i = 0; i < board.ids.size(); ++i) {
    TargetTag tag{board.ids[i], {}};
    for (std::size_t k = 0; k < 4; ++k) tag.corners.at(k) = place(board.markers[i][k]);
    const Vector2d middle = 0.5 * (tag.corners[0] + tag.corners[2]) / a;
    white[static_cast<std::size_t>(static_cast<int>(middle.y()) * spec.columns + static_cast<int>(middle.x()))] = true;
    add_bits(out, tag, false);
    out.tags.push_back(tag);
  }
  for (int row = 0; row < spec.rows; ++row)
    for (int column = 0; column < spec.columns; ++column)
      if (!white[static_cast<std::size_t>(row * spec.columns + column)])
        out.dark.push_back(patch(column * a, row * a, a, a));
  for (const cv::Point3f& corner : board.corners) out.corners.push_back(place(corner));
  return out;
}

void check_ratio(const TargetSpec& spec, const char* meaning) {
  if (!(spec.ratio > 0.0 && spec.ratio < 1.0))
    throw InputError::format("a target '{}' with ratio {:g}: must lie between 0 and 1 ({})", to_string(spec.kind),
                             spec.ratio, meaning);
}

void check_tags(const TargetSpec& spec, int count) {
  const int most = tag_family(spec.kind == TargetKind::AprilGrid)->bytesList.rows;
  if (count > most)
    throw InputError::format("a target '{}' with {} tags: its family has {}; take fewer rows or columns",
                             to_string(spec.kind), count, most);
}

void check_checkerboard(const TargetSpec& spec) {
  if (spec.rows < 3 || spec.columns < 3) throw InputError("a checkerboard needs at least 3 x 3 inner corners");
  if ((spec.rows + spec.columns) % 2 == 0)
    throw InputError::format(
        "a checkerboard of {} x {} inner corners looks the same when it is turned by 180 degrees; one of rows and "
        "columns must be odd, the other even",
        spec.rows, spec.columns);
}

/// Eight corners make a view, here and below.
void check_april_grid(const TargetSpec& spec) {
  check_ratio(spec, "gap over tag");
  if (spec.rows * spec.columns < 2) throw InputError("a target 'aprilgrid' needs at least two tags");
  check_tags(spec, spec.rows * spec.columns);
}

void check_charuco(const TargetSpec& spec) {
  check_ratio(spec, "marker over square");
  if (spec.rows < 3 || spec.columns < 3 || (spec.rows - 1) * (spec.columns - 1) < 8)
    throw InputError("a target 'charuco' needs at least 3 x 5 or 4 x 4 squares");
  check_tags(spec, spec.rows * spec.columns / 2);
}

struct KindRow {
  TargetKind kind;
  std::string_view name;
  int rows, columns;  ///< the usual target: these, size_m and ratio
  double size_m, ratio;
  TargetLayout (*layout)(const TargetSpec& spec);
  void (*check)(const TargetSpec& spec);
};

constexpr KindRow kKinds[] = {
    {TargetKind::Checkerboard, "checkerboard", 6, 9, 0.03, 0.0, checkerboard, check_checkerboard},
    {TargetKind::AprilGrid, "aprilgrid", 6, 6, 0.05, 0.3, april_grid, check_april_grid},
    {TargetKind::Charuco, "charuco", 6, 8, 0.04, 0.75, charuco, check_charuco}};

const KindRow& row_of(TargetKind kind) { return *std::ranges::find(kKinds, kind, &KindRow::kind); }

/// The share of [low, high] in the pixel from x to x + 1.
double share(double low, double high, int x) {
  return std::clamp(std::min(high, x + 1.0) - std::max<double>(low, x), 0.0, 1.0);
}

}  // namespace

std::optional<TargetKind> parse_target_kind(std::string_view text) {
  const auto* const row = std::ranges::find(kKinds, text, &KindRow::name);
  return row == std::end(kKinds) ? std::nullopt : std::optional(row->kind);
}

std::string_view to_string(TargetKind kind) { return row_of(kind).name; }

TargetSpec usual_target(TargetKind kind) {
  const KindRow& row = row_of(kind);
  return {kind, row.rows, row.columns, row.size_m, row.ratio};
}

void TargetSpec::visit(ConfigFields& fields) {
  std::vector<std::pair<std::string_view, TargetKind>> kinds;
  for (const KindRow& row : kKinds) kinds.emplace_back(row.name, row.kind);
  fields.choice("kind", kind, kinds, {.effect = "of the target"});
  fields.add("rows", rows, {"", 1, kMostLines, "of tags, of inner corners of a checkerboard, of squares of a charuco"});
  fields.add("columns", columns, {"", 1, kMostLines, "likewise"});
  fields.add("size_m", size_m, {"m", 1e-4, 10, "side of a tag or of a square"});
  fields.add("ratio", ratio, {"", 0, 1, "aprilgrid: gap over tag; charuco: marker over square"});
}

void TargetSpec::validate() const {
  const std::string_view name = to_string(kind);
  if (rows < 1 || columns < 1 || rows > kMostLines || columns > kMostLines)
    throw InputError::format("a target '{}' of {} x {}: rows and columns must be 1 to {}", name, rows, columns,
                             kMostLines);
  if (!(size_m > 0.0 && size_m <= 10.0))
    throw InputError::format("a target '{}' of size {:g} mm: must be above 0 and at most 10000", name, 1e3 * size_m);
  row_of(kind).check(*this);
}

std::string describe(const TargetSpec& spec) {
  const double mm = 1e3 * spec.size_m;
  switch (spec.kind) {
    case TargetKind::Checkerboard:
      return fmt::format("checkerboard of {} x {} inner corners, squares of {:g} mm", spec.rows, spec.columns, mm);
    case TargetKind::Charuco:
      return fmt::format("charuco of {} x {} squares of {:g} mm, markers {:g} of them", spec.rows, spec.columns, mm,
                         spec.ratio);
    case TargetKind::AprilGrid:
      break;
  }
  return fmt::format("aprilgrid of {} x {} tags of {:g} mm, gaps {:g} of them", spec.rows, spec.columns, mm,
                     spec.ratio);
}

TargetLayout layout_of(const TargetSpec& spec) {
  spec.validate();
  return row_of(spec.kind).layout(spec);
}

cv::Mat draw_target(const TargetLayout& layout, double px_per_m) {
  const int width = static_cast<int>(std::ceil(layout.width * px_per_m - 1e-9)),
            height = static_cast<int>(std::ceil(layout.height * px_per_m - 1e-9));
  cv::Mat_<float> dark(height, width, 0.0F);
  for (const TargetPatch& p : layout.dark) {
    const double x_0 = p.low.x() * px_per_m, x_1 = p.high.x() * px_per_m;
    const double y_0 = height - p.high.y() * px_per_m, y_1 = height - p.low.y() * px_per_m;
    for (int y = std::max(0, static_cast<int>(y_0)); y < std::min<double>(height, y_1); ++y)
      for (int x = std::max(0, static_cast<int>(x_0)); x < std::min<double>(width, x_1); ++x)
        dark(y, x) += static_cast<float>(share(x_0, x_1, x) * share(y_0, y_1, y));
  }
  cv::Mat out;
  cv::Mat(255.0F - 255.0F * cv::min(dark, 1.0F)).convertTo(out, CV_8U);
  return out;
}

}  // namespace edged
