// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A planar calibration target: checkerboard, grid of AprilTags or ChArUco; its corners and what of it is dark.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/config.hpp"

namespace edged {

/// Checkerboard: rows and columns count the inner corners. AprilGrid: tags of the family 36h11 as Kalibr lays them out,
/// number 0 at the bottom left, with dark squares in the gaps. Charuco: rows and columns count the squares; markers of
/// OpenCV's dictionary 6x6_250 lie in the white ones.
enum class TargetKind { Checkerboard, AprilGrid, Charuco };

struct TargetSpec {
  TargetKind kind = TargetKind::AprilGrid;
  int rows = 6, columns = 6;
  double size_m = 0.05;  ///< side of a square; of an AprilGrid: of a tag, with its dark border
  /// AprilGrid: gap between tags over the side of a tag. Charuco: side of a marker over that of a square.
  double ratio = 0.3;

  void visit(ConfigFields& fields);

  /// Throws InputError that says which value is impossible, and why.
  void validate() const;
  bool operator==(const TargetSpec&) const = default;
};

/// "checkerboard", "aprilgrid" or "charuco".
std::optional<TargetKind> parse_target_kind(std::string_view text);
std::string_view to_string(TargetKind kind);

/// The usual target of a kind: 6 x 6 tags; 6 x 9 corners; 6 x 8 squares.
TargetSpec usual_target(TargetKind kind);

/// "aprilgrid of 6 x 6 tags of 30 mm, gaps 0.3".
std::string describe(const TargetSpec& spec);

/// An axis-parallel rectangle of the target [m].
struct TargetPatch {
  Eigen::Vector2d low, high;
};

/// A square with bits: its number, and its corners in OpenCV's order, clockwise from the top left.
struct TargetTag {
  int id;
  std::array<Eigen::Vector2d, 4> corners;
};

/// In the frame T of the target: x to the right, y up, z towards the viewer; origin at the lower left corner of its
/// pattern. [m]
struct TargetLayout {
  double width = 0.0, height = 0.0;
  std::vector<Eigen::Vector2d> corners;  ///< by their number
  std::vector<TargetPatch> dark;         ///< the rest is white
  std::vector<TargetTag> tags;           ///< none of a checkerboard
  double margin = 0.0;                   ///< width of the white paper that is needed around it
};

/// Throws InputError as TargetSpec::validate.
TargetLayout layout_of(const TargetSpec& spec);

/// A picture of the layout, white on 255 and dark 0, with anti-aliased edges: the lower left corner of the layout is at
/// the lower left of the picture.
cv::Mat draw_target(const TargetLayout& layout, double px_per_m);

}  // namespace edged
