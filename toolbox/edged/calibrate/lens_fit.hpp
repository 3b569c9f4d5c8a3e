// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The lens of one camera from pictures of a target, without any value to start from.
#pragma once

#include <optional>
#include <vector>

#include "edged/calibrate/target_view.hpp"

namespace edged {

struct LensFit {
  FreeLens lens;
  double sigma_px = 0.0;                  ///< robust deviation of a coordinate of a corner
  double rms_px = 0.0;                    ///< of all corners, wrong ones and those that the model misses included
  LensParameters sigmas{};                ///< sigmas of the parameters; 0 for those that the model lacks
  std::vector<std::optional<SE3>> T_C_T;  ///< pose of each view; nothing where it does not fit
};

struct TargetCamera {
  TargetViews views;
  LensFit lens;
};

/// Tries focal lengths and shapes of the lens on a few views, goes on with the best of them, frees one group of
/// parameters after the other, and ends with all views, of which at most most_views evenly spread ones bear on the
/// lens. Throws InputError that says what to record where no lens of that model explains the views.
LensFit fit_lens(const TargetViews& camera, const TargetLayout& layout, DistortionModel distortion,
                 std::size_t most_views = 150);

/// With the model that explains the views: radtan, which every program reads, unless equidistant leaves a fifth less.
/// Radtan misses the corners near the border of a wide lens, where its polynomial turns back.
LensFit fit_best_lens(const TargetViews& camera, const TargetLayout& layout);

}  // namespace edged
