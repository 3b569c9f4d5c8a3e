// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Values at neighbouring pixels, which the renderer computes together.
#pragma once

#include <Eigen/Core>

namespace edged {

inline constexpr int kMostPixels = 128;

using PixelValues = Eigen::Array<float, Eigen::Dynamic, 1, 0, kMostPixels, 1>;

}  // namespace edged
