// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the views of a target cover of the image and of the directions that it may be seen from.
#pragma once

#include <string>
#include <vector>

#include "edged/calibrate/lens_fit.hpp"

namespace edged {

/// How many corners lie in each cell of the image.
struct CornerCells {
  static constexpr int kColumns = 8, kRows = 6;
  std::vector<std::size_t> corners =
      std::vector<std::size_t>(static_cast<std::size_t>(kColumns * kRows), 0);  ///< by row

  void add(const TargetView& view, int width, int height);
  /// Share of the cells that have some.
  double share() const;
  /// "upper left, top": the ninths of the image where most cells have none.
  std::string empty_parts() const;
};

struct ViewCoverage {
  CornerCells cells;
  /// Standard deviation of the target's tilt about the x and the y axis of the camera [rad].
  double tilt_x = 0.0, tilt_y = 0.0;
  double nearest_m = 0.0, farthest_m = 0.0;  ///< the middle of the target from the camera
};

ViewCoverage coverage_of(const TargetViews& camera, const LensFit& fit, const TargetLayout& layout);

/// What has to be recorded in addition, one line each: too little for a calibration, or less than is good for it.
struct MissingViews {
  std::vector<std::string> needed, advised;
};
MissingViews missing_views(const TargetViews& camera, const LensFit& fit, const ViewCoverage& coverage);

}  // namespace edged
