// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/coverage.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"

namespace edged {
namespace {

constexpr double kLeastShare = 0.5, kGoodShare = 0.8;
constexpr double kLeastTilt = 6.0 * kDegree, kGoodTilt = 12.0 * kDegree;
constexpr double kWorstFocal = 0.01;  // relative sigma

}  // namespace

void CornerCells::add(const TargetView& view, int width, int height) {
  for (const TargetCorner& corner : view.corners) {
    const int column = std::clamp(static_cast<int>(corner.pixel.x() * kColumns / width), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(corner.pixel.y() * kRows / height), 0, kRows - 1);
    ++corners[static_cast<std::size_t>(row * kColumns + column)];
  }
}

double CornerCells::share() const {
  const auto with = std::ranges::count_if(corners, [](std::size_t n) { return n > 0; });
  return static_cast<double>(with) / static_cast<double>(corners.size());
}

std::string CornerCells::empty_parts() const {
  constexpr const char* kParts[] = {"upper left", "top",        "upper right", "left",       "middle",
                                    "right",      "lower left", "bottom",      "lower right"};
  std::string out;
  for (int part = 0; part < 9; ++part) {
    int cells = 0, with = 0;
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        if (3 * row / kRows != part / 3 || 3 * column / kColumns != part % 3) continue;
        ++cells;
        with += corners[static_cast<std::size_t>(row * kColumns + column)] > 0 ? 1 : 0;
      }
    if (2 * with < cells) out += (out.empty() ? "" : ", ") + std::string(kParts[part]);
  }
  return out;
}

ViewCoverage coverage_of(const TargetViews& camera, const LensFit& fit, const TargetLayout& layout) {
  ViewCoverage out;
  out.nearest_m = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d middle(0.5 * layout.width, 0.5 * layout.height, 0.0);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < camera.views.size(); ++i) {
    if (!fit.T_C_T[i]) continue;
    out.cells.add(camera.views[i], camera.width, camera.height);
    const Eigen::Vector3d normal = fit.T_C_T[i]->rotation() * Eigen::Vector3d::UnitZ();
    const double distance = (*fit.T_C_T[i] * middle).norm();
    out.nearest_m = std::min(out.nearest_m, distance), out.farthest_m = std::max(out.farthest_m, distance);
    const Eigen::Vector2d tilt(std::asin(std::clamp(normal.y(), -1.0, 1.0)),
                               std::asin(std::clamp(normal.x(), -1.0, 1.0)));
    sum += tilt, squares += tilt.cwiseAbs2();
    count += 1.0;
  }
  if (count == 0.0) return out;
  const Eigen::Vector2d tilt = (squares / count - (sum / count).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  out.tilt_x = tilt.x(), out.tilt_y = tilt.y();
  return out;
}

MissingViews missing_views(const TargetViews& camera, const LensFit& fit, const ViewCoverage& coverage) {
  MissingViews out;
  const auto judge = [&out](bool needed, bool advised, const std::string& line) {
    if (needed)
      out.needed.push_back(line);
    else if (advised)
      out.advised.push_back(line);
  };
  const double share = coverage.cells.share();
  const std::string empty = coverage.cells.empty_parts();
  judge(share < kLeastShare, share < kGoodShare,
        fmt::format("camera {}: corners of the target in {:.0f} % of the image; bring it to {} as well", camera.name,
                    100.0 * share, empty.empty() ? "its borders" : empty));
  const double tilt = std::min(coverage.tilt_x, coverage.tilt_y);
  judge(tilt < kLeastTilt, tilt < kGoodTilt,
        fmt::format(
            "camera {}: the target is tilted by {:.0f} deg about {} (one sigma); tilt it by 30 deg to both sides "
            "there, as only that separates focal length and distance",
            camera.name, tilt / kDegree,
            coverage.tilt_x < coverage.tilt_y ? "the horizontal axis of the image" : "the vertical axis of the image"));
  // With a projection of its own (omni, ds, eucm), fx trades against its coefficients.
  const DistortionModel lens = fit.lens.distortion;
  if (lens == DistortionModel::OmniEquidistant || lens_model(lens).projection_parameters > 0) return out;
  const double focal = fit.sigmas[0] / fit.lens.values[0];
  judge(focal > kWorstFocal, focal > 0.3 * kWorstFocal,
        fmt::format("camera {}: the focal length is uncertain by {:.2f} %; record more views, nearer to the target",
                    camera.name, 100.0 * focal));
  return out;
}

}  // namespace edged
