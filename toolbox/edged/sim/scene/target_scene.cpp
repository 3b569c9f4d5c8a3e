// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/target_scene.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr int kSide = 2048;                                      // texels of the board
constexpr double kWhite = 230.0 / 255.0, kBlack = 14.0 / 255.0;  // albedo of paper and toner
constexpr double kToWall_m = 0.8;
const Eigen::Vector3d kCentre_W(0.0, 0.0, 1.3);

/// Seen by a camera that looks along x: u to the right, v down.
Face facing_minus_x(const Eigen::Vector3d& centre_W, double half_u, double half_v) {
  Face face;
  face.centre_W = centre_W;
  face.normal_W = -Eigen::Vector3d::UnitX();
  face.u_W = -Eigen::Vector3d::UnitY();
  face.v_W = -Eigen::Vector3d::UnitZ();
  face.half_u = half_u, face.half_v = half_v;
  return face;
}

}  // namespace

void add_target(Scene& scene, const SceneConfig& config) {
  const TargetLayout layout = layout_of(config.target);
  const double longest = std::max(layout.width, layout.height) + 2.0 * layout.margin;
  // The edges of a tag's bits, or of squares, lie between texels at every distance: else the halved copies of the
  // texture have lopsided edges, which shift corners by some hundredths of a pixel.
  const double unit_m = config.target.kind == TargetKind::AprilGrid ? 0.1 * config.target.size_m : config.target.size_m;
  int texels_per_unit = 1;
  while (2 * texels_per_unit * (longest / unit_m + 2.0) < kSide) texels_per_unit *= 2;
  const double texels_per_m = texels_per_unit / unit_m;
  const cv::Mat picture = draw_target(layout, texels_per_m);
  cv::Mat canvas(kSide, kSide, CV_8UC1, cv::Scalar(255));
  const int margin = texels_per_unit * static_cast<int>(std::ceil(layout.margin / unit_m - 1e-9));
  picture.copyTo(canvas(cv::Rect(margin, margin, picture.cols, picture.rows)));
  canvas.convertTo(canvas, CV_8U, kWhite - kBlack, 255.0 * kBlack);

  Face board = facing_minus_x(kCentre_W, 0.5 * layout.width + layout.margin, 0.5 * layout.height + layout.margin);
  board.texture = scene.textures.size();
  board.texels_per_m = static_cast<float>(texels_per_m);
  // The picture is aligned at its lower left.
  board.offset_u = static_cast<float>(margin + 0.5 * layout.width * texels_per_m);
  board.offset_v = static_cast<float>(margin + picture.rows - 0.5 * layout.height * texels_per_m);
  board.brightness = static_cast<float>(config.light);
  scene.textures.emplace_back(canvas);

  Face wall = facing_minus_x(kCentre_W + kToWall_m * Eigen::Vector3d::UnitX(), 40.0, 40.0);
  wall.brightness = static_cast<float>(0.7 * config.light);
  scene.faces.push_back(wall);
  scene.faces.push_back(board);
}

}  // namespace edged
